// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "posefusion/loop/ferns.hpp"
#include "posefusion/loop/verify.hpp"

namespace pf {

/// What is kept of a keyframe to find it again; people are out of its depth.
struct KeyframeView {
  std::int64_t id = 0;  ///< rises
  cv::Mat intensity;    ///< CV_8UC1, working resolution
  cv::Mat depth_mm;     ///< CV_16UC1, same size, 0 = nothing known
  PinholeCamera camera;
  Thumbnail thumbnail;
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  bool nobody_in_view = true;
};

KeyframeView keyframeView(const WorkingFrame& frame, std::int64_t id,
                          const Eigen::Isometry3d& T_map_camera, bool nobody_in_view);

/// The view as a frame to align.
WorkingFrame workingFrameOf(const KeyframeView& view);

/// A frame as a model to align with, in its own camera frame.
ModelView modelViewOf(const WorkingFrame& frame);

/// What a model view shows from another pose (in the frame of the view's camera), as far as its
/// pixels reach.
ModelView seenFrom(const ModelView& view, const Eigen::Isometry3d& T_view_camera);

/// Aligns frame `to` with frame `from`, starting from a guess, and judges as PlaceVerifier does.
/// The pose of the verdict is T_from_to, its covariance the twist's in the camera frame of `to`.
PlaceVerdict alignPair(const WorkingFrame& from, const WorkingFrame& to,
                       const Eigen::Isometry3d& T_from_to_guess, const TrackingConfig& tracking,
                       const VerifyLimits& limits);

}  // namespace pf
