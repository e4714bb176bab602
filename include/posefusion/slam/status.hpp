// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "posefusion/slam/outcome.hpp"
#include "posefusion/slam/reckoning.hpp"
#include "posefusion/tracking/result.hpp"
#include "posefusion/tracking/sparse_motion.hpp"

namespace pf {

/// The answer for one frame.
struct FrameStatus {
  std::int64_t stamp_ns = 0;
  TrackingState state = TrackingState::initializing;
  FrameOutcome outcome = FrameOutcome::fused;
  bool located = false;  ///< the pose is this frame's, in the first fragment; else none is known
  int fragment = kFirstFragment;  ///< that the pose is in
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  TrackingResult tracking;
  Matrix6d covariance = Matrix6d::Zero();  ///< of the pose, as published: Location::covariance
  SparseMotion motion;                     ///< since the frame before
  /// Of a frame that is not located, by dead reckoning.
  std::optional<ProvisionalPose> provisional;
  std::string detail;            ///< the reason in words
  bool is_other_camera = false;  ///< refused because it is not of the map's camera
  std::size_t surfels = 0;
  int map_version = 0;     ///< number of corrections so far
  bool map_full = false;   ///< the memory limit keeps new surfels out
  double tracking_ms = 0;  ///< preprocessing, rendering and alignment
  double fusion_ms = 0;    ///< fusion and cleaning
};

/// Why the frame was not fused: "bad_input: there is no depth image"; empty when it was.
std::string reasonOf(const FrameStatus& status);

}  // namespace pf
