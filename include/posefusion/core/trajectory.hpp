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

/// From a camera's optical frame (z forward, x right, y down) to axes with x forward, y left, z up
/// (REP-103). Exact. Files of results are in the frame of the first camera turned so: z is up where
/// that camera is level.
inline Eigen::Isometry3d bodyFromOptical() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return T;
}

/// The same poses in another world.
inline Trajectory inWorld(const Eigen::Isometry3d& T_new_old, Trajectory trajectory) {
  for (StampedPose& pose : trajectory) pose.T_world_camera = T_new_old * pose.T_world_camera;
  return trajectory;
}

}  // namespace pf
