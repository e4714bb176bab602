// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "random_pose.hpp"
#include "test_data.hpp"

namespace pf {
namespace {

/// A random walk at 10 Hz.
Trajectory randomWalk(unsigned seed, int length) {
  std::mt19937 random(seed);
  Trajectory walk;
  Eigen::Isometry3d T = randomPose(random);
  for (int i = 0; i < length; ++i) {
    walk.push_back({i * 100 * kMs, T});
    T = T * randomPose(random, 0.1);
  }
  return walk;
}

Trajectory noisy(Trajectory trajectory, double noise) {
  std::mt19937 random(9);
  for (auto& pose : trajectory)
    pose.T_world_camera = pose.T_world_camera * randomPose(random, noise);
  return trajectory;
}

double ateOf(const Trajectory& truth, const Trajectory& estimate, bool with_scale = false) {
  const auto pairs = matchPoses(truth, estimate);
  return absoluteError(pairs, align(pairs, with_scale)).rmse;
}

TEST(Statistics, OfAHandMadeList) {
  const auto s = statisticsOf({3, 1, 2, 10});
  EXPECT_EQ(s.count, 4U);
  EXPECT_DOUBLE_EQ(s.mean, 4);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.max, 10);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt((9.0 + 1 + 4 + 100) / 4));
  EXPECT_DOUBLE_EQ(s.min, 1);
  EXPECT_DOUBLE_EQ(s.squares_sum, 9.0 + 1 + 4 + 100);
  EXPECT_DOUBLE_EQ(s.deviation, std::sqrt((1.0 + 9 + 4 + 36) / 4));
  EXPECT_EQ(statisticsOf({}).count, 0U);
}

TEST(MatchStamps, TakesTheClosestFirstAndEachOnce) {
  // 100 is nearer to 101 than 98 is, so 98 gets 95, which is left.
  const auto pairs = matchStamps({98, 100}, {101, 95}, 5);
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0], std::make_pair(std::size_t{0}, std::size_t{1}));
  EXPECT_EQ(pairs[1], std::make_pair(std::size_t{1}, std::size_t{0}));
}

TEST(MatchStamps, TheLargestDifferenceIsOut) {
  EXPECT_EQ(matchStamps({0}, {20}, 20).size(), 0U);
  EXPECT_EQ(matchStamps({0}, {19}, 20).size(), 1U);
  EXPECT_EQ(matchStamps({0}, {-20}, 20).size(), 0U);
  EXPECT_TRUE(matchStamps({}, {1}, 20).empty());
}

TEST(Ate, OfAHandMadeCase) {
  // Corners of a square; the estimate has one moved out by h along the normal of the plane. The
  // best fit leaves +-h/4 at all four corners.
  const double side = 1.0, h = 0.004;
  Trajectory truth(4), estimate;
  const Eigen::Vector3d corners[] = {{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}};
  for (int i = 0; i < 4; ++i) {
    truth[static_cast<std::size_t>(i)].stamp_ns = i * 100 * kMs;
    truth[static_cast<std::size_t>(i)].T_world_camera.translation() = corners[i];
  }
  estimate = truth;
  estimate[2].T_world_camera.translation().z() = h;
  EXPECT_NEAR(ateOf(truth, estimate), h / 4, 1e-5);
}

TEST(Ate, IsZeroForTheTruthInAnotherFrame) {
  const Trajectory truth = randomWalk(1, 80);
  std::mt19937 random(2);
  const Eigen::Isometry3d T = randomPose(random);
  Trajectory moved = truth;
  for (auto& pose : moved) pose.T_world_camera = T * pose.T_world_camera;
  EXPECT_NEAR(ateOf(truth, moved), 0, 1e-12);
}

TEST(Ate, DoesNotChangeWithTheFrameOfEitherTrajectory) {
  const Trajectory truth = randomWalk(1, 80);
  Trajectory estimate = noisy(truth, 0.05);
  const double before = ateOf(truth, estimate);
  EXPECT_GT(before, 0.01);
  std::mt19937 random(2);
  const Eigen::Isometry3d T = randomPose(random, 2.0);
  for (auto& pose : estimate) pose.T_world_camera = T * pose.T_world_camera;
  EXPECT_NEAR(ateOf(truth, estimate), before, 1e-12);
  EXPECT_NEAR(ateOf(estimate, truth), before, 1e-12) << "symmetric without scale";
}

TEST(Ate, WithScaleFindsTheScale) {
  const Trajectory truth = randomWalk(1, 80);
  Trajectory half = truth;
  for (auto& pose : half) pose.T_world_camera.translation() *= 0.5;
  const auto pairs = matchPoses(truth, half);
  EXPECT_NEAR(align(pairs, true).scale, 2.0, 1e-12);
  EXPECT_NEAR(ateOf(truth, half, true), 0, 1e-12);
  EXPECT_GT(ateOf(truth, half), 0.01);
  EXPECT_LE(ateOf(truth, noisy(truth, 0.1), true), ateOf(truth, noisy(truth, 0.1)));
}

TEST(Ate, NoAlignmentIsBetterThanTheFoundOne) {
  const Trajectory truth = randomWalk(5, 60);
  const auto pairs = matchPoses(truth, noisy(truth, 0.1));
  const Alignment best = align(pairs, false);
  const double error = absoluteError(pairs, best).rmse;
  std::mt19937 random(6);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Isometry3d step = randomPose(random, 0.01);
    Alignment other = best;
    other.rotation = step.linear() * best.rotation;
    other.translation += step.translation();
    EXPECT_GE(absoluteError(pairs, other).rmse, error);
  }
}

TEST(Ate, NeedsThreePairs) {
  Trajectory truth = randomWalk(1, 2);
  EXPECT_THROW(align(matchPoses(truth, truth), false), InputError);
  Trajectory late = randomWalk(1, 10);
  for (auto& pose : late) pose.stamp_ns += 50 * kMs;
  EXPECT_THROW(align(matchPoses(randomWalk(1, 10), late), false), InputError);
}

TEST(AlignPoses, FindsTheRotationThatAStraightPathLeavesOpen) {
  Trajectory truth, estimate;
  std::mt19937 random(7);
  const Eigen::Isometry3d T = randomPose(random, 2.0);
  for (int i = 0; i < 50; ++i) {
    Eigen::Isometry3d pose = randomPose(random, 0.005);
    pose.translation().x() += 0.02 * i;
    truth.push_back({i * 100 * kMs, pose});
    estimate.push_back({i * 100 * kMs, T.inverse() * pose * randomPose(random, 0.005)});
  }
  const Eigen::Isometry3d found = alignPoses(matchPoses(truth, estimate));
  EXPECT_LT(logSo3(found.linear() * T.linear().transpose()).norm(), 0.003);
  EXPECT_LT((found.translation() - T.translation()).norm(), 0.01);
  EXPECT_THROW(alignPoses({}), InputError);
}

TEST(Rpe, OfAConstantDriftIsTheDrift) {
  // 10 Hz along x at 1 m/s; the estimate is 2 % long and turns by 0.1 degrees a frame about x.
  Trajectory truth, estimate;
  for (int i = 0; i < 50; ++i) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation().x() = 0.1 * i;
    truth.push_back({i * 100 * kMs, T});
    T.translation().x() *= 1.02;
    T.linear() = expSo3(Eigen::Vector3d(0.1 * M_PI / 180 * i, 0, 0));
    estimate.push_back({i * 100 * kMs, T});
  }
  const auto frame = relativeErrorPerFrame(truth, estimate);
  EXPECT_NEAR(frame.translation_m.rmse, 0.002, 1e-12);
  EXPECT_NEAR(frame.rotation_deg.max, 0.1, 1e-9);
  EXPECT_EQ(frame.translation_m.count, 48U) << "the last pose is left out, as in TUM's tool";
  const auto second = relativeErrorPerSecond(truth, estimate);
  EXPECT_NEAR(second.translation_m.median, 0.02, 1e-12);
  EXPECT_NEAR(second.rotation_deg.rmse, 1.0, 1e-9);
  EXPECT_NEAR(relativeErrorPerSecond(truth, estimate, 1 / 1.02).translation_m.max, 0, 1e-12);
}

TEST(Rpe, DoesNotChangeWithTheFrameOfEitherTrajectory) {
  const Trajectory truth = randomWalk(1, 80);
  Trajectory estimate = noisy(truth, 0.05);
  const auto before = relativeErrorPerSecond(truth, estimate);
  std::mt19937 random(2);
  const Eigen::Isometry3d T = randomPose(random, 2.0);
  for (auto& pose : estimate) pose.T_world_camera = T * pose.T_world_camera;
  const auto after = relativeErrorPerSecond(truth, estimate);
  EXPECT_NEAR(after.translation_m.rmse, before.translation_m.rmse, 1e-12);
  EXPECT_NEAR(after.rotation_deg.rmse, before.rotation_deg.rmse, 1e-9);
}

TEST(Rpe, OfTooShortTrajectoriesHasNoPairs) {
  const Trajectory truth = randomWalk(1, 5);
  EXPECT_EQ(relativeErrorPerSecond(truth, truth).translation_m.count, 0U);
  EXPECT_EQ(relativeErrorPerSecond({}, truth).translation_m.count, 0U);
  EXPECT_EQ(relativeErrorPerFrame(truth, {}).translation_m.count, 0U);
}

struct Reference {
  const char* truth;
  const char* estimate;
  std::size_t pairs;
  double ate_m;
};

class AteReference : public testing::TestWithParam<Reference> {};

TEST_P(AteReference, AgreesToTheLastPrintedDigit) {
  const auto& r = GetParam();
  const std::string folder = testData("trajectories/");
  POSEFUSION_REQUIRE_DATA(folder);
  const auto pairs =
      matchPoses(loadTrajectory(folder + r.truth), loadTrajectory(folder + r.estimate));
  EXPECT_EQ(pairs.size(), r.pairs);
  EXPECT_NEAR(absoluteError(pairs, align(pairs, false)).rmse, r.ate_m, 0.5e-6);
}

INSTANTIATE_TEST_SUITE_P(Tum, AteReference,
                         testing::Values(Reference{"freiburg1_xyz-groundtruth.txt",
                                                   "freiburg1_xyz-rgbdslam.txt", 786, 0.013473},
                                         Reference{"fr2_desk_groundtruth.txt", "fr2_desk_ORB.txt",
                                                   2223, 0.008144}));

}  // namespace
}  // namespace pf
