// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/pipeline.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "posefusion/map/surfel_map.hpp"
#include "simulated_sequence.hpp"

namespace pf {
namespace {

Config smallConfig() {
  Config config;
  config.frame.shrink = 1;
  config.pose.detector = "recorded";
  return config;
}

/// One person walks before the camera. Without systematic errors of depth, which turn and stretch
/// any map by some centimetres: what remains is the chain's own.
const SimulatedSequence& walker() {
  static const SimulatedSequence drawn("box_walker", 50, {"depth.distortion=0"});
  return drawn;
}

Pipeline makePipeline(const Config& config, const SimulatedSequence& sequence) {
  RecordedPeople people;
  for (int i = 0; i < sequence.frameCount(); ++i) {
    people[sequence.stamp(i)] = sequence.frame(i).people;
  }
  return Pipeline(config, makePoseDetector(config.pose, std::move(people)));
}

/// Error of the last pose after the whole sequence.
double finalErrorM(Pipeline& pipeline, const SimulatedSequence& sequence) {
  FrameStatus status;
  for (int i = 0; i < sequence.frameCount(); ++i) {
    status = pipeline.process(sequence.frame(i).frame).status;
  }
  return (status.T_map_camera.translation() -
          sequence.pose(sequence.frameCount() - 1).translation())
      .norm();
}

TEST(Pipeline, RemovesAWalkingFigureThatWouldPullTheCamera) {
  const SimulatedSequence& sequence = walker();
  Config elastic = smallConfig();
  applyMode(elastic, "elastic");
  Pipeline with = makePipeline(smallConfig(), sequence);
  Pipeline without = makePipeline(elastic, sequence);
  const double error = finalErrorM(with, sequence);
  EXPECT_LT(error, 0.01);
  EXPECT_GT(finalErrorM(without, sequence), 5 * error);
}

TEST(Pipeline, SeeingAheadChangesNothing) {
  const SimulatedSequence& sequence = walker();
  Pipeline serial = makePipeline(smallConfig(), sequence);
  Pipeline ahead = makePipeline(smallConfig(), sequence);
  std::vector<SeenFrame> seen;
  for (int i = 0; i < 12; ++i) seen.push_back(ahead.see(sequence.frame(i).frame));
  for (int i = 0; i < 12; ++i) {
    const FrameStatus a = serial.process(sequence.frame(i).frame).status;
    const FrameStatus b = ahead.map(seen[i]).status;
    EXPECT_TRUE(a.T_map_camera.matrix() == b.T_map_camera.matrix()) << "frame " << i;
    EXPECT_EQ(a.surfels, b.surfels);
  }
}

TEST(Pipeline, ABlurredFrameIsReportedAndNotFused) {
  const SimulatedSequence& sequence = walker();
  Pipeline pipeline = makePipeline(smallConfig(), sequence);
  for (int i = 0; i < 5; ++i) pipeline.process(sequence.frame(i).frame);
  const std::size_t surfels = pipeline.mapper().map().size();
  RgbdFrame smeared = sequence.frame(5).frame;
  cv::GaussianBlur(smeared.color, smeared.color, {}, 6);
  const ProcessedFrame out = pipeline.process(smeared);
  EXPECT_FALSE(out.seen.blur.sharp);
  EXPECT_EQ(out.status.outcome, FrameOutcome::blurred);
  EXPECT_EQ(out.status.state, TrackingState::tracking);
  EXPECT_EQ(pipeline.mapper().map().size(), surfels);
}

TEST(Pipeline, ABadFrameInTheMiddleIsDroppedAndTheRestGoesOn) {
  const SimulatedSequence& sequence = walker();
  Pipeline pipeline = makePipeline(smallConfig(), sequence);
  for (int i = 0; i < 9; ++i) {
    RgbdFrame frame = sequence.frame(i).frame;
    if (i == 3) frame.depth = cv::Mat();
    if (i == 4) frame.color = frame.color(cv::Rect(0, 0, 100, 100)).clone();
    if (i == 5) {  // a consistent frame, but of another camera
      frame.color = frame.color(cv::Rect(0, 0, 160, 120)).clone();
      frame.depth = frame.depth(cv::Rect(0, 0, 160, 120)).clone();
      frame.camera.width = 160;
      frame.camera.height = 120;
      frame.camera.cx = 80;
      frame.camera.cy = 60;
    }
    const FrameStatus status = pipeline.process(frame).status;
    const bool bad = i >= 3 && i <= 5;
    EXPECT_EQ(status.outcome, bad ? FrameOutcome::bad_input : FrameOutcome::fused) << "frame " << i;
    EXPECT_EQ(status.detail.empty(), !bad);
  }
}

}  // namespace
}  // namespace pf
