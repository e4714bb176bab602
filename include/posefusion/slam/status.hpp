// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "posefusion/slam/reckoning.hpp"
#include "posefusion/tracking/result.hpp"
#include "posefusion/tracking/sparse_motion.hpp"

namespace pf {

enum class TrackingState {
  initializing,  ///< no frame has been fused yet
  tracking,      ///< located, fused
  doubtful,      ///< located for now by dead reckoning or by an alignment that is not believed; not
                 ///< fused
  lost           ///< not located
};

/// What became of a frame, and why it was not fused.
enum class FrameOutcome {
  fused,          ///< believed, and taken into the map
  bad_input,      ///< sizes, encodings or stamps that cannot be used
  blurred,        ///< dropped by the gate
  no_depth,       ///< too few valid pixels to track (all zero, covered, people everywhere)
  not_converged,  ///< the alignment did not settle
  few_inliers,    ///< too little of the frame agrees with the model
  degenerate,     ///< the images leave directions free, and no corners help
  jumped,         ///< the motion is too large to be true
  disagrees,      ///< alignment and corners tell of different motions
  seen_through,   ///< the frame sees through too much of the model
  unproven,       ///< after a loss: looks right, but not for long enough
  forced,         ///< passed the blur gate only because too many were dropped before it
  located         ///< believed as one that is fused, in a map that must not change
};

/// Whether the frame was believed, so that there is nothing to complain of.
inline bool isGood(FrameOutcome outcome) {
  return outcome == FrameOutcome::fused || outcome == FrameOutcome::located;
}

std::string_view name(TrackingState state);
std::string_view name(FrameOutcome outcome);

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
