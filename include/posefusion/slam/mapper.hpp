// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "posefusion/core/frame.hpp"
#include "posefusion/frame/model_view.hpp"
#include "posefusion/slam/config.hpp"
#include "posefusion/tracking/result.hpp"

namespace pf {

class SurfelMap;

enum class TrackingState { initializing, tracking, lost };

/// What became of a frame, and why it was not fused.
enum class FrameOutcome {
  fused,
  bad_input,      ///< sizes, encodings or stamps that cannot be used
  blurred,        ///< dropped by the gate
  no_depth,       ///< too few valid pixels to track (all zero, covered, people everywhere)
  not_converged,  ///< the alignment did not settle
  few_inliers,    ///< too little of the frame agrees with the model
  jumped,         ///< the motion is too large to be true
};

std::string_view name(TrackingState state);
std::string_view name(FrameOutcome outcome);

/// The answer for one frame. The pose is the last trusted one where the outcome is not `fused`.
struct FrameStatus {
  std::int64_t stamp_ns = 0;
  TrackingState state = TrackingState::initializing;
  FrameOutcome outcome = FrameOutcome::fused;
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  TrackingResult tracking;
  std::string detail;  ///< in words, where a bad input or a doubtful alignment was found
  std::size_t surfels = 0;
  bool map_full = false;   ///< the memory limit keeps new surfels out
  double tracking_ms = 0;  ///< preprocessing, rendering and alignment
  double fusion_ms = 0;    ///< fusion and cleaning
};

/// Why the frame was not fused: "bad_input: there is no depth image"; empty when it was.
std::string reasonOf(const FrameStatus& status);

/// Owns the map: tracks each static frame against it and fuses it. Not thread safe.
class Mapper {
 public:
  explicit Mapper(const Config& config);
  ~Mapper();

  /// `frame.depth` has no people left in it; `mask` (CV_8UC1, 255 = person, may be empty) tells
  /// which pixels' colour is a person's.
  FrameStatus process(const RgbdFrame& frame, const cv::Mat& mask);

  /// The status of a frame that is not mapped (blurred, bad input): the state stays as it is.
  FrameStatus skip(std::int64_t stamp_ns, FrameOutcome outcome) const;

  /// The map as seen from the last trusted pose, for the segmenter; empty before the first frame.
  /// The images are valid until the next call of process() or reset(): clone what must live longer.
  const ModelView& view() const;

  /// The map rendered from any pose with any camera (colour included): pictures, checks.
  ModelView render(const PinholeCamera& camera, const Eigen::Isometry3d& T_map_camera) const;

  const SurfelMap& map() const;

  /// Forgets everything; the next frame starts a new map at `T_map_camera` (identity at first).
  void reset(const Eigen::Isometry3d& T_map_camera = Eigen::Isometry3d::Identity());

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pf
