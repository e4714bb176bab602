// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/grid/occupancy_grid.hpp"

namespace pf {

/// Throws InputError naming a file whose name does not end in .yaml.
void requireGridName(const std::string& path);

/// Writes a grid as map_server of ROS reads it: `path` (*.yaml), and the image that it names beside
/// it, PGM or, `png`, PNG: 254 is free, 0 occupied, 205 unknown, the first row the largest y.
/// Throws InputError naming the file.
void saveGrid(const std::string& path, const OccupancyGrid& grid, bool png = false);

/// Reads what saveGrid() writes. Throws InputError naming the file.
OccupancyGrid loadGrid(const std::string& path);

}  // namespace pf
