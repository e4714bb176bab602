// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posefusion/blur/gate.hpp"
#include "posefusion/calibration/color_learner.hpp"
#include "posefusion/frame/flow.hpp"
#include "posefusion/pose/detector.hpp"
#include "posefusion/robot/robot_recording.hpp"
#include "posefusion/segmentation/segmenter.hpp"
#include "posefusion/slam/config.hpp"
#include "posefusion/slam/loop_thread.hpp"
#include "posefusion/slam/mapper.hpp"

namespace pf {

/// A frame after the stages that need no map, ready for the others.
struct SeenFrame {
  RgbdFrame frame;
  BlurScore blur;
  People people;
  FlowImages flow;  ///< from the last sharp frame; empty for a frame that is not mapped
  double gate_ms = 0;
  double pose_ms = 0;
  double flow_ms = 0;
};

/// A frame after the whole chain.
struct ProcessedFrame {
  SeenFrame seen;
  Segmentation segmentation;
  double segmentation_ms = 0;
  FrameStatus status;
  /// Handing questions to the loop closer and taking its answers in; NaN: not known.
  double loop_ms = std::numeric_limits<double>::quiet_NaN();
  /// Waiting for answers, which a run without a clock does so that they come in at the same frame
  /// on every machine; NaN: not known.
  double loop_wait_ms = std::numeric_limits<double>::quiet_NaN();
};

/// The whole chain, free of ROS: the offline runner, the tests and the benchmarks. `see` and `map`
/// keep apart state and may run on two threads, each in the order of the frames; the result is that
/// of process() in one thread, to the bit.
class Pipeline {
 public:
  Pipeline(const Config& config, std::unique_ptr<PoseDetector> detector);

  /// Rectification, blur gate, registration of colour, pose detection, optical flow.
  SeenFrame see(const RgbdFrame& frame);

  /// Segmentation against the current model, tracking, fusion. A blurred frame is reported as such.
  ProcessedFrame map(SeenFrame seen);

  ProcessedFrame process(const RgbdFrame& frame) { return map(see(frame)); }

  /// Before the first frame: goes on in a saved map; see Mapper::load().
  void load(SavedMap map, MapUse use) { mapper_.load(std::move(map), use); }

  /// Before load() and the first frame; see Mapper::calibrate().
  void calibrate(const DepthCalibration& calibration) { mapper_.calibrate(calibration); }

  /// Before the first frame: the camera of colour that is not registered to depth.
  void registerColor(const ColorCamera& camera) { color_.give(camera); }

  /// Before the first frame: the measurements of the robot's other sensors during the recording.
  void accompany(RobotRecording recording) { robot_ = RobotPlayback(std::move(recording)); }

  /// Between two frames: takes in loops found elsewhere; see Mapper::take().
  void take(const LoopAnswer& answer) { mapper_.take(answer); }

  /// After the last frame: takes in the loop closer's last answers, and refines the map where the
  /// settings ask for it. Returns what that did, or why nothing, in a line.
  std::string finish();

  const LoopCounts& loopCounts() const { return loop_thread_.counts(); }

  /// See LoopExchange::verificationMs().
  const std::vector<double>& loopVerificationMs() const { return loop_thread_.verificationMs(); }

  /// How colour lies over depth, once that was looked at. In the thread of see(), or after it.
  const std::optional<ColorEstimate>& colorEstimate() const { return color_.estimate(); }

  const Mapper& mapper() const { return mapper_; }

 private:
  Config config_;
  Rectifier rectifier_;
  BlurGate gate_;
  ColorLearner color_;
  std::unique_ptr<PoseDetector> detector_;
  FlowTracker flow_;
  PeopleSegmenter segmenter_;
  RobotPlayback robot_;
  Mapper mapper_;
  LoopThread loop_thread_;
};

}  // namespace pf
