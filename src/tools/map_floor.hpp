// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/grid/floor_map.hpp"

namespace pf {

/// Throws InputError naming the file, also where no floor is in it.
FloorMap readFloorMap(const std::string& file);

}  // namespace pf
