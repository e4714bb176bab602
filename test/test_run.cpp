// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <limits>
#include <stdexcept>

#include "posefusion/map/surfel_map.hpp"
#include "posefusion/run/run.hpp"
#include "simulated_sequence.hpp"

namespace pf {
namespace {

constexpr int kRunFrames = 20;

const SimulatedSequence& sequence() {
  static const SimulatedSequence drawn("box_walker", kRunFrames);
  return drawn;
}

/// A simulated sequence; frame `bad` is unreadable, reading stops with an exception at `broken`.
class SimulatedSource : public FrameSource {
 public:
  int bad = -1, broken = -1;
  std::atomic<int> read{0};

  std::size_t frameCount() const override { return kRunFrames; }
  std::optional<SourceFrame> next() override {
    const int i = read++;
    if (i == broken) throw std::runtime_error("the disk is gone");
    if (i >= kRunFrames) return std::nullopt;
    SourceFrame out;
    out.frame = sequence().frame(i).frame;
    if (i != bad) return out;
    out.defect = "not a whole image";
    out.frame.color.release();
    return out;
  }
  RecordedPeople people() override {
    RecordedPeople people;
    for (int i = 0; i < kRunFrames; ++i) people[sequence().stamp(i)] = sequence().frame(i).people;
    return people;
  }
};

struct Result {
  std::vector<Eigen::Matrix4d> poses;
  std::vector<FrameOutcome> outcomes;
  std::vector<int> masked;
  std::vector<float> surfel_x;

  void add(const ProcessedFrame& frame) {
    poses.push_back(frame.status.T_map_camera.matrix());
    outcomes.push_back(frame.status.outcome);
    const cv::Mat& mask = frame.segmentation.mask;
    masked.push_back(mask.empty() ? 0 : cv::countNonZero(mask));
  }
  bool operator==(const Result& other) const {
    return poses == other.poses && outcomes == other.outcomes && masked == other.masked &&
           surfel_x == other.surfel_x;
  }
};

Config config() {
  Config config;
  config.pose.detector = "recorded";
  return config;
}

std::unique_ptr<Pipeline> makePipeline() {
  return std::make_unique<Pipeline>(config(),
                                    makePoseDetector(config().pose, SimulatedSource().people()));
}

Result runThreaded() {
  SimulatedSource source;
  const auto pipeline = makePipeline();
  Result result;
  runPipeline(source, *pipeline, [&](const ProcessedFrame& frame, const std::string&) {
    result.add(frame);
    return true;
  });
  result.surfel_x = pipeline->mapper().map().collect().x;
  return result;
}

Result runSerially() {
  SimulatedSource source;
  const auto pipeline = makePipeline();
  Result result;
  while (auto next = source.next()) result.add(pipeline->process(next->frame));
  result.surfel_x = pipeline->mapper().map().collect().x;
  return result;
}

TEST(RunPipeline, GivesWhatOneThreadGivesToTheBit) {
  const Result serial = runSerially();
  ASSERT_EQ(serial.poses.size(), static_cast<std::size_t>(kRunFrames));
  EXPECT_GT(serial.surfel_x.size(), 1000U);
  EXPECT_TRUE(runThreaded() == serial);
  for (const std::size_t threads : {1U, 2U, 3U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_TRUE(runThreaded() == serial) << threads << " threads";
  }
}

TEST(RunPipeline, StopsOnRequestAndDoesNotReadFarAhead) {
  SimulatedSource source;
  const auto pipeline = makePipeline();
  int done = 0;
  runPipeline(source, *pipeline,
              [&](const ProcessedFrame&, const std::string&) { return ++done < 3; });
  EXPECT_EQ(done, 3);
  EXPECT_LT(source.read, kRunFrames);
}

TEST(RunPipeline, AnUnreadableFrameIsReportedAndTheRestGoesOn) {
  SimulatedSource source;
  source.bad = 2;
  const auto pipeline = makePipeline();
  std::vector<std::string> defects;
  Result result;
  runPipeline(source, *pipeline, [&](const ProcessedFrame& frame, const std::string& defect) {
    result.add(frame);
    defects.push_back(defect);
    return true;
  });
  ASSERT_EQ(defects.size(), static_cast<std::size_t>(kRunFrames));
  EXPECT_EQ(defects[2], "not a whole image");
  EXPECT_EQ(result.outcomes[2], FrameOutcome::bad_input);
  EXPECT_EQ(defects[3], "");
  EXPECT_EQ(result.outcomes[3], FrameOutcome::fused);
}

/// Runs the sequence with the depth of frames 5 to 9 replaced.
Result runWithDepth(const cv::Mat& depth) {
  const auto pipeline = makePipeline();
  Result result;
  for (int i = 0; i < kRunFrames; ++i) {
    RgbdFrame frame = sequence().frame(i).frame;
    if (i >= 5 && i < 10) frame.depth = depth;
    result.add(pipeline->process(frame));
  }
  return result;
}

TEST(BadDepth, AllZeroOrAllNanIsNotFusedAndTrackingGoesOnAfterIt) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (const cv::Mat& depth :
       {cv::Mat(240, 320, CV_16UC1, cv::Scalar(0)), cv::Mat(240, 320, CV_32FC1, cv::Scalar(nan)),
        cv::Mat(240, 320, CV_32FC1, cv::Scalar(infinity))}) {
    const Result result = runWithDepth(depth);
    for (std::size_t i = 5; i < 10; ++i) {
      EXPECT_EQ(result.outcomes[i], FrameOutcome::no_depth) << i;
      // Corners with known positions carry the pose.
      EXPECT_LT((result.poses[i] - sequence().pose(static_cast<int>(i)).matrix()).norm(), 0.02)
          << i;
    }
    for (std::size_t i = 10; i < kRunFrames; ++i)
      EXPECT_EQ(result.outcomes[i], FrameOutcome::fused);
    EXPECT_LT((result.poses.back() - sequence().pose(kRunFrames - 1).matrix()).norm(), 0.05);
  }
}

TEST(BadDepth, FromTheFirstFrameOnWaitsForDepth) {
  const auto pipeline = makePipeline();
  RgbdFrame blind = sequence().frame(0).frame;
  blind.depth = cv::Mat::zeros(240, 320, CV_16UC1);
  const auto first = pipeline->process(blind).status;
  EXPECT_EQ(first.outcome, FrameOutcome::no_depth);
  EXPECT_EQ(first.state, TrackingState::initializing);
  EXPECT_EQ(pipeline->process(sequence().frame(1).frame).status.outcome, FrameOutcome::fused);
}

TEST(RunPipeline, WhatReadingThrowsArrivesAfterTheFramesBefore) {
  SimulatedSource source;
  source.broken = 4;
  const auto pipeline = makePipeline();
  int done = 0;
  EXPECT_THROW(runPipeline(source, *pipeline,
                           [&](const ProcessedFrame&, const std::string&) { return ++done > 0; }),
               std::runtime_error);
  EXPECT_EQ(done, 4);
}

TEST(RunPipeline, WhatTheCallerThrowsArrives) {
  SimulatedSource source;
  const auto pipeline = makePipeline();
  EXPECT_THROW(runPipeline(source, *pipeline,
                           [&](const ProcessedFrame&, const std::string&) -> bool {
                             throw std::logic_error("no");
                           }),
               std::logic_error);
}

}  // namespace
}  // namespace pf
