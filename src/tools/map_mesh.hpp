// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

namespace pf {

/// posefusion_map mesh MAP -o FILE
void addMeshCommand(CLI::App& app);

}  // namespace pf
