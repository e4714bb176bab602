// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pf {

/// Makes one map of two (merge()), writes it into the new map `output` and prints what that did.
/// Throws InputError naming what cannot be read or written, and both maps where they do not become
/// one.
void mergeMaps(const std::string& first, const std::string& second, const std::string& output);

}  // namespace pf
