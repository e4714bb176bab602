// SPDX-License-Identifier: BSD-3-Clause
// Fusion and its loop closer: loops that close, a closer that is missing, stalled, or comes late.
#include <gtest/gtest.h>
#include <nav_msgs/Path.h>

#include <functional>

#include "../temporary_folder.hpp"
#include "chain_fixture.hpp"
#include "fake_closer.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/slam/pipeline.hpp"
#include "posefusion_ros/transforms.hpp"

namespace posefusion_ros {
namespace {

constexpr int kThere = 40;
constexpr double kSmallError = 0.0005;

/// Keyframes come often, and a loop leads back over few of them.
pf::Config loopyConfig() {
  pf::Config config;
  config.pose.detector = "none";
  config.frame.shrink = 1;
  config.graph.keyframe_distance_m = 0.05;
  config.loop.min_gap_keyframes = 2;
  config.graph.loop_sigma_m = kSmallError;  // the room is exact: so that loops have to correct
  config.graph.loop_sigma_rad = kSmallError;
  return config;
}

void setLoopy(Chain& chain) {
  chain.set("frame/shrink", 1);
  chain.set("graph/keyframe_distance_m", 0.05);
  chain.set("loop/min_gap_keyframes", 2);
  chain.set("graph/loop_sigma_m", kSmallError);
  chain.set("graph/loop_sigma_rad", kSmallError);
}

/// Frame `index` of a camera that moves to and fro in the empty room.
pf::RgbdFrame toAndFro(int index) {
  const int turn = index % (2 * kThere);
  pf::RgbdFrame frame = emptyRoom().frame(turn < kThere ? turn : 2 * kThere - 1 - turn).frame;
  frame.stamp_ns = 1'000'000'000LL + index * 33'333'333LL;
  return frame;
}

TrackingStatusMsg process(Chain& chain, int index) {
  return chain.process(toMessages(toAndFro(index)));
}

TEST(ChainCloser, LoopsCloseAsInTheOfflineChainToTheBit) {
  const pf::TemporaryFolder folder;
  Chain chain("closing");
  setLoopy(chain);
  chain.set("output", folder.str());
  ASSERT_TRUE(chain.load());
  pf::Pipeline pipeline(loopyConfig(), pf::makePoseDetector(loopyConfig().pose, {}));
  for (int i = 0; i < 2 * kThere; ++i) {
    const pf::FrameStatus expected = pipeline.process(toAndFro(i)).status;
    const TrackingStatusMsg status = process(chain, i);
    ASSERT_EQ(outcome(status), static_cast<int>(expected.outcome)) << i << status.reason;
    ASSERT_EQ(static_cast<int>(status.map_version), expected.map_version) << i;
    EXPECT_EQ(status.fragment, 0U);
    EXPECT_EQ(status.unanswered, 0U);
  }
  pipeline.finish();
  chain.unload();
  const pf::BackEnd& back_end = pipeline.mapper().backEnd();
  ASSERT_GT(back_end.graph().version(), 0) << "the test needs loops that close";
  pf::saveTrajectory(folder / "expected.txt",
                     pf::inWorld(pf::bodyFromOptical(), back_end.trajectory()), "");
  pf::saveMap(folder / "expected.ply", pipeline.mapper().map(), pf::bodyFromOptical());
  EXPECT_EQ(posesIn(folder / "latest/trajectory.txt"), posesIn(folder / "expected.txt"));
  EXPECT_EQ(pf::readFile(folder / "latest/map.ply"), pf::readFile(folder / "expected.ply"));
}

TEST(ChainCloser, ThePathFollowsCorrections) {
  Chain chain("path");
  setLoopy(chain);
  chain.set("path_period_s", 0.0);
  std::mutex mutex;
  std::map<ros::Time, nav_msgs::Path> paths;  // by the newest pose
  const boost::function<void(const nav_msgs::Path::ConstPtr&)> note = [&](const auto& path) {
    const std::lock_guard<std::mutex> lock(mutex);
    paths[path->header.stamp] = *path;
  };
  auto subscriber = chain.handle().subscribe<nav_msgs::Path>(topics::kPath, 1000, note);
  ASSERT_TRUE(chain.load());
  pf::Pipeline pipeline(loopyConfig(), pf::makePoseDetector(loopyConfig().pose, {}));
  const pf::BackEnd& back_end = pipeline.mapper().backEnd();
  int corrections = 0, checked = 0;
  for (int i = 0; i < 2 * kThere && checked < 3; ++i) {
    const int version = back_end.graph().version();
    pipeline.process(toAndFro(i));
    process(chain, i);
    if (back_end.graph().version() > version) {
      ++corrections;  // the next frame's path has it
      continue;
    }
    const ros::Time now = toTime(toAndFro(i).stamp_ns);
    if (corrections == 0) continue;
    ASSERT_TRUE(Chain::waitUntil([&] {
      const std::lock_guard<std::mutex> lock(mutex);
      return paths.count(now) > 0;
    }));
    std::map<ros::Time, Eigen::Isometry3d> camera;
    for (const auto& pose : back_end.trajectory()) {
      camera[toTime(pose.stamp_ns)] = pf::bodyFromOptical() * pose.T_world_camera;
    }
    const std::lock_guard<std::mutex> lock(mutex);
    ++checked;
    ASSERT_GT(paths[now].poses.size(), 5U);
    for (const auto& pose : paths[now].poses) {
      const Eigen::Vector3d expected = camera.at(pose.header.stamp).translation();
      EXPECT_NEAR(pose.pose.position.x, expected.x(), 1e-9);
      EXPECT_NEAR(pose.pose.position.y, expected.y(), 1e-9);
      EXPECT_NEAR(pose.pose.position.z, expected.z(), 1e-9);
    }
  }
  EXPECT_GT(checked, 0) << "the test needs loops that close";
  subscriber.shutdown();
}

TEST(ChainCloser, OthersSeeQuestionsAndAnswersAsMessages) {
  Chain chain("seen");
  setLoopy(chain);
  // Otherwise constraints are measured again once depth was corrected, by questions without a
  // keyframe.
  chain.set("calibration/mode", std::string("frozen"));
  std::mutex mutex;
  std::vector<KeyframeMsg> questions;
  std::vector<LoopConstraintMsg> answers;
  const boost::function<void(const KeyframeMsg::ConstPtr&)> on_question = [&](const auto& message) {
    const std::lock_guard<std::mutex> lock(mutex);
    questions.push_back(*message);
  };
  const boost::function<void(const LoopConstraintMsg::ConstPtr&)> on_answer =
      [&](const auto& message) {
        const std::lock_guard<std::mutex> lock(mutex);
        answers.push_back(*message);
      };
  auto asked = chain.handle().subscribe<KeyframeMsg>(topics::kKeyframe, 100, on_question);
  auto answered =
      chain.handle().subscribe<LoopConstraintMsg>(topics::kLoopConstraint, 100, on_answer);
  ASSERT_TRUE(chain.load());
  for (int i = 0; i < 2 * kThere; ++i) process(chain, i);
  chain.unload();
  ASSERT_TRUE(Chain::waitUntil([&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return questions.size() > 3 && questions.size() == answers.size();
  }));
  asked.shutdown();
  answered.shutdown();
  const std::lock_guard<std::mutex> lock(mutex);
  std::size_t loops = 0;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const KeyframeMsg& question = questions[i];
    EXPECT_EQ(static_cast<int>(question.wanted), KeyframeMsg::LOOPS);
    EXPECT_EQ(question.keyframe, i);
    EXPECT_EQ(question.intensity.width, question.camera.width);
    EXPECT_EQ(question.depth.encoding, "16UC1");
    EXPECT_EQ(answers[i].number, question.number);
    EXPECT_EQ(answers[i].header.stamp, question.header.stamp);
    EXPECT_EQ(answers[i].to, question.keyframe);
    EXPECT_EQ(answers[i].from.size(), answers[i].pose.size());
    EXPECT_EQ(answers[i].error, "");
    EXPECT_EQ(answers[i].keyframes, i + 1);
    loops += answers[i].from.size();
  }
  EXPECT_EQ(answers.back().accepted, loops);
  EXPECT_GT(loops, 0U);
}

TEST(ChainCloser, OneThatIsMissingIsCountedAndOneThatComesGetsAllKeyframes) {
  Chain chain("missing");
  setLoopy(chain);
  chain.set("closer_timeout_s", 0.2);
  ASSERT_TRUE(chain.loadWithoutCloser());
  int next = 0;
  for (; next < kThere; ++next) {
    EXPECT_EQ(outcome(process(chain, next)), TrackingStatusMsg::FUSED) << next;
  }
  const auto unanswered = chain.statuses().back().unanswered;
  EXPECT_GT(unanswered, 0U);
  FakeCloser late(chain);
  late.answers(true);
  for (; next < 3 * kThere && late.known() == 0; ++next) process(chain, next);
  EXPECT_GT(late.known(), 1) << "keyframes of before";
}

TEST(ChainCloser, OneThatDoesNotAnswerIsWaitedForOnceUntilItDoes) {
  Chain chain("stalled");
  setLoopy(chain);
  chain.set("closer_timeout_s", 1.0);
  FakeCloser closer(chain);
  ASSERT_TRUE(chain.loadWithoutCloser());
  const auto begin = std::chrono::steady_clock::now();
  int next = 0;
  for (; next < kThere; ++next) {
    EXPECT_EQ(outcome(process(chain, next)), TrackingStatusMsg::FUSED) << next;
  }
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
  const auto unanswered = chain.statuses().back().unanswered;
  EXPECT_GT(unanswered, 2U);
  EXPECT_GT(passed.count(), 1.0) << "the first was waited for";
  closer.answers(true);
  const int asked = closer.asked();
  for (; next < 4 * kThere && closer.asked() < asked + 3; ++next) process(chain, next);
  // Questions asked before are still given up when they become due.
  for (int i = 0; i < 12; ++i) process(chain, next++);
  const auto settled = chain.statuses().back().unanswered;
  for (int i = 0; i < kThere; ++i) process(chain, next++);
  EXPECT_GT(closer.asked(), asked + 3);
  EXPECT_EQ(chain.statuses().back().unanswered, settled);
}

TEST(ChainCloser, FusionGoesWhileItWaitsForAnAnswer) {
  Chain chain("waiting");
  setLoopy(chain);
  chain.set("closer_timeout_s", 600.0);  // no test would last so long
  const FakeCloser closer(chain);
  ASSERT_TRUE(chain.loadWithoutCloser());
  const int lag = pf::Pace().framesIn(loopyConfig().loop.answer_lag_s);
  for (int i = 0; i < lag; ++i) process(chain, i);
  chain.send(toMessages(toAndFro(lag)));  // the answer to the first keyframe is due
  ros::WallDuration(0.5).sleep();
  EXPECT_EQ(chain.statuses().size(), static_cast<std::size_t>(lag));
  chain.unload("fusion");
  EXPECT_TRUE(chain.hasLostFusion());
}

TEST(ChainCloser, LiveNothingWaits) {
  Chain chain("live_stalled");
  setLoopy(chain);
  chain.set("lossless", false);
  chain.set("queue_size", 1000);
  chain.set("closer_timeout_s", 600.0);
  const FakeCloser closer(chain);
  ASSERT_TRUE(chain.loadWithoutCloser());
  for (int i = 0; i < kThere; ++i) {
    EXPECT_EQ(outcome(process(chain, i)), TrackingStatusMsg::FUSED) << i;
  }
  EXPECT_GT(closer.asked(), 1);
  EXPECT_EQ(chain.statuses().back().unanswered, 0U) << "an answer may still come";
  chain.unload();
}

TEST(ChainCloser, ItGoesWhileItWorksAndTheNextOneGetsAllKeyframes) {
  Chain chain("reloaded");
  setLoopy(chain);
  chain.set("closer_timeout_s", 600.0);  // an answer that was lost is not waited for
  std::atomic<std::uint64_t> keyframes{0}, known{0};
  const boost::function<void(const LoopAnswerMessage::ConstPtr&)> note = [&](const auto& answer) {
    keyframes = answer->keyframe + 1;
    known = answer->answer.counts.keyframes;
  };
  auto answers = chain.handle().subscribe<LoopAnswerMessage>(topics::kLoopConstraint, 100, note);
  ASSERT_TRUE(chain.load());
  int next = 0;
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < kThere; ++i) {
      if (i == kThere / 2) chain.unload("loop_closer");
      EXPECT_EQ(outcome(process(chain, next++)), TrackingStatusMsg::FUSED);
    }
    ASSERT_TRUE(chain.load({"loop_closer"}));
    for (int i = 0; i < 5; ++i) process(chain, next++);
  }
  const std::uint64_t before = keyframes;
  EXPECT_TRUE(Chain::waitUntil([&] {
    process(chain, next++);
    return keyframes > before && known == keyframes;
  }));
  answers.shutdown();
}

}  // namespace
}  // namespace posefusion_ros
