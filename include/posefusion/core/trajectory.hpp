// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

namespace pf {

struct StampedPose {
  std::int64_t stamp_ns = 0;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
};

/// Poses in the order of their stamps.
using Trajectory = std::vector<StampedPose>;

/// The pose at a time between two, or just after the later: positions on a line, turning at a
/// constant rate.
Eigen::Isometry3d poseBetween(const StampedPose& a, const StampedPose& b, std::int64_t stamp_ns);

/// The pose of just that time, so between two of the trajectory. Nothing where none of it is within
/// 0.02 s.
std::optional<Eigen::Isometry3d> poseAt(const Trajectory& poses, std::int64_t stamp_ns);

/// From a camera's optical frame (z forward, x right, y down) to axes with x forward, y left, z up
/// (REP-103). Exact. Files of results are in the frame of the first camera turned so: z is up where
/// that camera is level.
inline Eigen::Isometry3d bodyFromOptical() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return T;
}

/// The same for a camera that is not level: to a frame of the same origin whose z axis is up, and
/// whose x axis is where the camera looks, level. `up`: direction against gravity in the optical
/// frame.
Eigen::Isometry3d levelFromOptical(const Eigen::Vector3d& up);

/// The same poses in another world.
inline Trajectory inWorld(const Eigen::Isometry3d& T_new_old, Trajectory trajectory) {
  for (StampedPose& pose : trajectory) pose.T_world_camera = T_new_old * pose.T_world_camera;
  return trajectory;
}

}  // namespace pf
