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
  MapPose pose;
  bool nobody_in_view = true;
};

/// Pictures whose directions differ by more than this see a surface at different image positions,
/// where the errors of the sensor differ: a loop between them is wrong by far more than its
/// covariance.
constexpr double kMostTurn_rad = 0.26;

KeyframeView keyframeView(const WorkingFrame& frame, std::int64_t id, const MapPose& pose,
                          bool nobody_in_view);

/// A keyframe as a frame to align, and as a model to align with. Holds much memory, and reuses it.
struct KeyframePicture {
  WorkingFrame frame;
  ModelView model;      ///< in the frame's own camera frame
  ModelPyramid points;  ///< of the model

  /// `sensor`: that took it.
  void assign(const KeyframeView& view, const DepthSensor& sensor);
};

/// Depth, normals and grey levels of a model view as seen from another pose (in the frame of the
/// view's camera), as far as its pixels reach. Reuses the memory of `moved`; where its depth is 0
/// the other planes are undefined.
void seenFrom(const ModelView& view, const Eigen::Isometry3d& T_view_camera, ModelView& moved);

/// Aligns keyframes with each other and judges as PlaceVerifier does. Keeps buffers between calls;
/// not thread safe.
class PairAligner {
 public:
  explicit PairAligner(const TrackingConfig& tracking) : tracking_(tracking) {}

  /// Starts from a guess. The pose of the verdict is T_from_to, its covariance the twist's in the
  /// camera frame of `to`.
  PlaceVerdict align(const KeyframePicture& from, const KeyframePicture& to,
                     const Eigen::Isometry3d& T_from_to_guess);

  /// Is the alignment the other way round accepted too, and does it agree with T_from_to?
  bool confirms(const KeyframePicture& from, const KeyframePicture& to,
                const Eigen::Isometry3d& T_from_to);

 private:
  TrackingConfig tracking_;
  ModelView seen_;
};

}  // namespace pf
