// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "posefusion/core/camera.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// The blocks of the pose's fragment, in the order of the map, that may hold a disc in the camera's
/// picture not farther than `max_depth_m` along the optical axis (0: any distance). None in view is
/// missed; some that are not may be named. Rendering, fusion and cleaning all go by this list.
std::vector<std::uint32_t> visibleBlocks(const SurfelMap& map, const PinholeCamera& camera,
                                         const MapPose& pose, double max_depth_m);

/// Some surfels of one block, [begin, end): the unit of parallel work.
struct SurfelRange {
  std::uint32_t block = 0;
  std::uint32_t begin = 0, end = 0;
};

/// Most surfels of a range: their projections fit into the first-level cache.
constexpr std::uint32_t kRangeSurfels = 512;

/// Cuts the blocks into ranges, in order.
std::vector<SurfelRange> rangesOf(const SurfelMap& map, const std::vector<std::uint32_t>& blocks);

}  // namespace pf
