// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/loop_thread.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "loop_scene.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "posefusion/slam/mapper.hpp"

namespace pf {
namespace {

constexpr int kAfter = 60;

struct Carried {
  FrameStatus status;
  int frames = 0;  ///< from the first view to being found
};

/// Maps the room, covers the camera, and uncovers it elsewhere.
Carried carry(const std::optional<AnswerTime>& closer) {
  Config config;
  config.frame.shrink = 1;
  Mapper mapper(config);
  std::optional<LoopThread> loops;
  if (closer) loops.emplace(config, *closer);
  std::int64_t stamp_ns = 0;
  Carried carried;
  const auto see = [&](int index, bool covered) {
    StaticFrame input;
    input.frame = room().frame(index).frame;
    input.frame.stamp_ns = stamp_ns += 33333333;
    if (covered) input.frame.depth.setTo(0);
    carried.status = mapper.process(input);
    if (loops) loops->serve(mapper);
  };
  for (int i = 0; i < kMapped; ++i) see(i, false);
  for (int i = 0; i < kCovered; ++i) see(kMapped - 1, true);
  EXPECT_EQ(carried.status.state, TrackingState::lost);
  const int elsewhere = farthestFrame();
  for (; carried.frames < kAfter; ++carried.frames) {
    see(elsewhere, false);
    if (carried.status.state == TrackingState::tracking) break;
  }
  return carried;
}

TEST(LoopThread, ALostCameraIsFoundElsewhere) {
  const int there = farthestFrame();
  const double moved =
      (room().pose(there).translation() - room().pose(kMapped - 1).translation()).norm();
  ASSERT_GT(moved, 0.1) << "the test needs a camera that was carried";
  const Carried found = carry(AnswerTime::after_lag);
  ASSERT_EQ(found.status.state, TrackingState::tracking);
  EXPECT_GT(found.frames, LoopConfig().answer_lag_s) << "an answer is never early";
  EXPECT_LT(found.frames, 40);
  EXPECT_LT((found.status.T_map_camera.translation() - room().pose(there).translation()).norm(),
            0.02);
}

TEST(LoopThread, AnsweredQuestionsAreForgotten) {
  // A session has thousands; those for a place hold a copy of the map each.
  Config config;
  config.frame.shrink = 1;
  Mapper mapper(config);
  LoopThread loops(config, AnswerTime::after_lag);
  for (int i = 0; i < kMapped; ++i) {
    mapper.process({room().frame(i).frame, cv::Mat(), {}});
    loops.serve(mapper);
  }
  loops.finish(mapper);
  ASSERT_GT(mapper.keyframeViews().size(), 1U);
  for (const KeyframeView& view : mapper.keyframeViews()) {
    EXPECT_EQ(view.intensity.u->refcount, 2) << "the mapper's and the closer's, not a question's";
  }
}

TEST(LoopThread, AnswersDependOnNeitherSpeedNorThreads) {
  const Carried many = carry(AnswerTime::after_lag);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Carried single = carry(AnswerTime::after_lag);
  EXPECT_EQ(many.frames, single.frames);
  EXPECT_EQ(many.status.T_map_camera.matrix(), single.status.T_map_camera.matrix());
}

TEST(LoopThread, LiveNothingWaitsForAnAnswer) {
  Config config;
  LoopThread loops(config, AnswerTime::when_ready);
  Mapper mapper(config);
  loops.serve(mapper);
  mapper.process({room().frame(0).frame, {}, {}});
  loops.serve(mapper);  // the question of the first keyframe
  loops.finish(mapper);
  EXPECT_EQ(loops.counts().keyframes, 1U);
  ASSERT_EQ(loops.verificationMs().size(), 1U);
  EXPECT_GT(loops.verificationMs()[0], 0.0);
  mapper.reset();
  loops.reset();
  mapper.process({room().frame(1).frame, {}, {}});
  loops.serve(mapper);
  loops.finish(mapper);
  EXPECT_EQ(loops.counts().keyframes, 1U) << "a map of its own";
}

}  // namespace
}  // namespace pf
