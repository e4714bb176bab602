// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pf {

/// Writes the map `file`, refined (Mapper::refine()), into the new map `output` and prints what
/// that did. Throws InputError naming what cannot be read or written.
void refineMap(const std::string& file, const std::string& output);

}  // namespace pf
