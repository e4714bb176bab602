// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

namespace pf {

/// Where a folder of the package ("config", "models") may lie: in the source tree, and where it is
/// installed, the first that has a file counts.
std::vector<std::filesystem::path> packageFolders(const std::filesystem::path& name);

}  // namespace pf
