// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace pf {

struct StampedPose {
  std::int64_t stamp_ns = 0;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
};

/// Poses in the order of their stamps.
using Trajectory = std::vector<StampedPose>;

}  // namespace pf
