// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "posefusion/grid/occupancy_grid.hpp"

namespace pf {

/// A map that stands level on its floor, and what its keyframes see of it.
struct FloorMap {
  SurfelArrays surfels;  ///< stable ones, in the frame of the floor
  Eigen::Isometry3d T_floor_world = Eigen::Isometry3d::Identity();  ///< from that of results
  std::vector<SeenPoints> seen;                                     ///< in the frame of the floor

  double leaning_rad() const;  ///< of the frame of results
};

/// Throws InputError naming the file, also where no floor is in it.
FloorMap readFloorMap(const std::string& file);

OccupancyGrid gridOf(const FloorMap& map, const GridConfig& config);

}  // namespace pf
