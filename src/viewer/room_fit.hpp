// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "posefusion/loop/map_points.hpp"
#include "posefusion_ros/surfel_cloud.hpp"

namespace posefusion_ros {

/// The box, along the axes of the map, that holds the room: of each axis the outermost hundredth of
/// the surfels is left out. Empty of none.
Eigen::AlignedBox3f boundsOf(const std::vector<SurfelPoint>& surfels);

/// The floor: the lowest large level among surfels that face up (within 35 degrees of z, for a map
/// that does not know of gravity). Nothing where too few do.
std::optional<pf::Levels> floorOf(const std::vector<SurfelPoint>& surfels);

}  // namespace posefusion_ros
