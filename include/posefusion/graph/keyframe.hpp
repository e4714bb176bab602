// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "posefusion/core/map_pose.hpp"

namespace pf {

/// A node of the pose graph.
struct Keyframe {
  int id = -1;  ///< place in PoseGraph::keyframes(), which gives it
  int fragment = kFirstFragment;
  std::int64_t stamp_ns = 0;
  std::int32_t map_frame = 0;  ///< number of the fused frame, as in SurfelArrays::created
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  /// Retired: it and what hangs on it move rigidly with this keyframe, and no constraint ends here;
  /// -1: in use.
  int follows = -1;

  bool isRetired() const { return follows >= 0; }
};

/// The pose of any frame, kept relative to a keyframe, so that it follows corrections.
struct RelativePose {
  int keyframe = -1;
  Eigen::Isometry3d T_keyframe_camera = Eigen::Isometry3d::Identity();
};

/// The pose in the map. Throws std::out_of_range where there is no such keyframe.
inline Eigen::Isometry3d poseOf(const RelativePose& pose, const std::vector<Keyframe>& keyframes) {
  return keyframes.at(static_cast<std::size_t>(pose.keyframe)).T_map_camera *
         pose.T_keyframe_camera;
}

/// Where a frame was.
struct FrameRecord {
  std::int64_t stamp_ns = 0;
  RelativePose pose;
};

}  // namespace pf
