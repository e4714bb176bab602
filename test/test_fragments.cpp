// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/map_pose.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "posefusion/core/se3.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "posefusion/slam/loop_thread.hpp"
#include "posefusion/slam/mapper.hpp"
#include "simulated_sequence.hpp"

namespace pf {
namespace {

constexpr int kMapped = 60, kCovered = 20, kLookedAbout = 6;

const SimulatedSequence& room() { return exactBox<kMapped>(); }

/// Maps a room, covers the camera for long, and uncovers it elsewhere: all of its view, or that
/// part of the columns.
struct Carried {
  explicit Carried(const Config& config, bool with_closer, double uncovered = 1.0)
      : mapper_(config) {
    if (with_closer) loops_.emplace(config, AnswerTime::after_lag);
    for (int i = 0; i < kMapped / 2; ++i) see(i);
    surfels_ = stableAtHome();
    for (int i = 0; i < kCovered; ++i) see(kMapped / 2, 0);
    EXPECT_EQ(status_.outcome, FrameOutcome::no_depth);
    EXPECT_EQ(status_.fragment, 0) << "not without anything to see";
    for (int i = 0; i < kLookedAbout; ++i) see(kMapped - 1, uncovered);
  }

  static Config config() {
    Config c;
    c.frame.shrink = 1;
    c.loop.new_fragment_after_s = 0.1;  // before the search for the place has an answer
    c.loop.min_gap_keyframes = 1000;    // it is that search that joins, no pair of keyframes
    return c;
  }

  const FrameStatus& see(int index, double uncovered = 1.0) {
    StaticFrame input;
    input.frame = room().frame(index).frame;
    input.frame.stamp_ns = stamp_ns_ += 33333333;
    const int columns = static_cast<int>(uncovered * input.frame.depth.cols);
    input.frame.depth.colRange(columns, input.frame.depth.cols).setTo(0);
    status_ = mapper_.process(input);
    tracked_ += status_.state == TrackingState::tracking ? 1U : 0U;
    if (loops_) loops_->serve(mapper_);
    return status_;
  }

  /// Error of the position of the last frame.
  double errorM(int index) const {
    return (status_.T_map_camera.translation() - room().pose(index).translation()).norm();
  }

  Mapper mapper_;
  std::optional<LoopThread> loops_;
  std::int64_t stamp_ns_ = 0;
  FrameStatus status_;
  std::size_t tracked_ = 0;  ///< frames, in whatever fragment
  /// Stable surfels that lie with the map's origin.
  std::size_t stableAtHome() const {
    const SurfelMap& map = mapper_.map();
    std::size_t count = 0;
    map.forEachSurfelOf(kFirstFragment, [&](const SurfelArrays& s, std::size_t i) {
      count += map.isStable(s, i) ? 1 : 0;
    });
    return count;
  }

  std::size_t surfels_ = 0;  ///< stable ones, before the loss
};

TEST(Fragments, ALostCameraMapsOnInCoordinatesOfItsOwn) {
  Carried run(Carried::config(), false);
  for (int i = kMapped - 1; i > kMapped / 2; --i) {
    const FrameStatus& status = run.see(i);
    ASSERT_EQ(status.state, TrackingState::tracking) << "frame " << i;
    EXPECT_EQ(status.fragment, 1);
    EXPECT_FALSE(status.located) << "its pose is unknown";
    EXPECT_LT(status.T_map_camera.translation().norm(), 3) << "near the origin of the fragment";
  }
  EXPECT_EQ(run.stableAtHome(), run.surfels_) << "the map is as it was";
  EXPECT_GT(run.mapper_.map().stableCount(), run.surfels_ + 1000);
  EXPECT_EQ(run.mapper_.backEnd().trajectory().size(), std::size_t{kMapped / 2});
}

TEST(Fragments, OneBeginsAtAnOriginOfItsOwn) {
  const Carried run(Carried::config(), false);
  const Keyframe& last = run.mapper_.backEnd().graph().keyframes().back();
  EXPECT_EQ(last.fragment, 1);
  EXPECT_EQ(last.T_map_camera.translation().norm(), 0);
  for (const SurfelBlock& block : run.mapper_.map().blocks()) {
    EXPECT_LE(block.fragment, 1);
    EXPECT_LT(block.bounds.center().norm(), 8.0F) << "coordinates overlap, blocks are apart";
  }
}

TEST(Fragments, NoneIsBegunWhereThatIsOff) {
  for (const bool off : {true, false}) {
    Config config = Carried::config();
    config.loop.enabled = off;
    if (off) config.loop.new_fragment_after_s = 0;
    Carried run(config, false);
    EXPECT_EQ(run.status_.fragment, 0);
    EXPECT_EQ(run.mapper_.map().stableCount(), run.surfels_);
  }
}

TEST(Fragments, NoneIsBegunByACameraThatIsNearlyCovered) {
  Carried run(Carried::config(), false, 0.15);
  EXPECT_NE(run.status_.outcome, FrameOutcome::no_depth);
  EXPECT_EQ(run.status_.state, TrackingState::lost);
  EXPECT_EQ(run.status_.fragment, 0);
  EXPECT_EQ(run.mapper_.map().stableCount(), run.surfels_);
}

TEST(Fragments, OneThatWasLostAndFoundAgainIsNotFoundInItself) {
  Carried run(Carried::config(), false);
  for (int i = kMapped - 1; i > 40; --i) run.see(i);
  for (int i = 0; i < kCovered; ++i) run.see(40, 0);
  ASSERT_EQ(run.status_.state, TrackingState::lost);
  for (int i = 0; i < 15; ++i) run.see(40);
  ASSERT_EQ(run.status_.state, TrackingState::tracking);
  ASSERT_EQ(run.status_.fragment, 1) << "it is back where it was lost";
  const Config config = Carried::config();
  run.loops_.emplace(config, AnswerTime::after_lag);
  run.mapper_.introduceCloser();
  for (int i = 40; i >= 0; --i) run.see(i);
  for (int i = 0; i < 40; ++i) run.see(i);
  EXPECT_EQ(run.mapper_.backEnd().counts().joined, 1U);
  EXPECT_EQ(run.status_.fragment, 0) << "it lies in the map of before";
  EXPECT_LT(run.errorM(39), 0.02);
}

/// Covers the camera, uncovers it at a frame, and gives its place; it is accepted.
void findAt(Carried& run, int index, const MapPose& pose) {
  for (int i = 0; i < kCovered; ++i) run.see(index, 0);
  run.mapper_.introduceCloser();  // so that it asks
  run.see(index);
  ASSERT_EQ(run.status_.state, TrackingState::lost);
  LoopAnswer answer;
  answer.asked_for_place = true;
  answer.place.emplace();
  answer.place->doubt = PlaceDoubt::none;
  answer.place->log_odds = 10;
  answer.place->fragment = pose.fragment;
  answer.place->alignment.T_map_camera = pose.T_map_camera;
  run.mapper_.take(answer);
  for (int i = 0; i < 5; ++i) run.see(index);
  ASSERT_EQ(run.status_.state, TrackingState::tracking) << run.status_.detail;
  EXPECT_EQ(run.status_.fragment, pose.fragment);
  const auto& keyframes = run.mapper_.backEnd().graph().keyframes();
  EXPECT_EQ(keyframes.back().fragment, pose.fragment);
  const PoseConstraint& tie = run.mapper_.backEnd().graph().constraints().back();
  EXPECT_EQ(tie.to, keyframes.back().id) << "what comes back is tied";
  EXPECT_EQ(keyframes[static_cast<std::size_t>(tie.from)].fragment, pose.fragment);
}

TEST(Fragments, ACameraThatIsLostInOneIsFoundInAnother) {
  Carried run(Carried::config(), false);
  run.see(kMapped - 1);
  const MapPose away{1, run.status_.T_map_camera};
  ASSERT_EQ(run.status_.fragment, away.fragment);
  const std::size_t poses = run.mapper_.backEnd().trajectory().size();
  findAt(run, 10, {kFirstFragment, room().pose(10)});
  EXPECT_TRUE(run.status_.located);
  EXPECT_LT(run.errorM(10), 0.02);
  EXPECT_GT(run.mapper_.backEnd().trajectory().size(), poses);
  findAt(run, kMapped - 1, away);
  EXPECT_FALSE(run.status_.located);
  const Eigen::Isometry3d off = away.T_map_camera.inverse() * run.status_.T_map_camera;
  EXPECT_LT(off.translation().norm(), 0.02);
}

TEST(Fragments, AreJoinedWhenTheirPlaceIsFound) {
  Carried run(Carried::config(), true);
  int joined_after = 0;
  for (int i = kMapped - 1; i >= 0; --i) {
    run.see(i);
    ASSERT_EQ(run.status_.state, TrackingState::tracking) << "frame " << i;
    EXPECT_TRUE(i < kMapped - 1 || run.status_.fragment == 1);
    if (run.status_.fragment == 1) ++joined_after;
  }
  EXPECT_LT(joined_after, 50) << "frames until it is known where the fragment lies";
  EXPECT_EQ(run.status_.fragment, 0);
  EXPECT_TRUE(run.status_.located);
  EXPECT_LT(run.errorM(0), 0.02);
  EXPECT_EQ(run.mapper_.backEnd().counts().joined, 1U);
  EXPECT_EQ(run.stableAtHome(), run.mapper_.map().stableCount()) << "all came along";
  const Trajectory poses = run.mapper_.backEnd().trajectory();
  ASSERT_EQ(poses.size(), run.tracked_) << "and the poses since the fragment began";
  const Eigen::Isometry3d first = poses[kMapped / 2].T_world_camera;
  EXPECT_LT((first.translation() - room().pose(kMapped - 1).translation()).norm(), 0.02);
}

}  // namespace
}  // namespace pf
