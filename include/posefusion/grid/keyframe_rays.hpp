// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "posefusion/core/camera.hpp"
#include "posefusion/graph/keyframe.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// Where a camera stood, and what of the map it saw from there (m, map frame).
struct SeenPoints {
  Eigen::Vector3f from = Eigen::Vector3f::Zero();
  std::vector<Eigen::Vector3f> points;
};

/// Calls visit(seen) for each keyframe of the first fragment: the stable surfels that it saw, one
/// ray in 4 x 4 pixels, as they are in the map now. People and what has moved are not in it.
void forEachKeyframe(const SurfelMap& map, const PinholeCamera& camera,
                     const std::vector<Keyframe>& keyframes,
                     const std::function<void(const SeenPoints&)>& visit);

}  // namespace pf
