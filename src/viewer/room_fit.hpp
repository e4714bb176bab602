// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "posefusion_ros/surfel_cloud.hpp"

namespace posefusion_ros {

/// A plane: normal * p = height.
struct FloorPlane {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  float height = 0;
};

/// The box, along the axes of the map, that holds the room: of each axis the outermost hundredth of
/// the surfels is left out. Empty of none.
Eigen::AlignedBox3f boundsOf(const std::vector<SurfelPoint>& surfels);

/// The lowest large plane among surfels that face up (within 35 degrees of z, for a map that does
/// not know of gravity). Nothing where too few do.
std::optional<FloorPlane> floorOf(const std::vector<SurfelPoint>& surfels);

}  // namespace posefusion_ros
