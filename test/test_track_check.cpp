// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/evaluation/track_check.hpp"
#include "random_pose.hpp"

namespace pf {
namespace {

constexpr int kLength = 200;  // 20 s at 10 Hz

/// A walk in a circle, looking ahead.
Trajectory circle() {
  Trajectory walk;
  for (int i = 0; i < kLength; ++i) {
    const double angle = 0.03 * i;
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = expSo3({0, 0, angle});
    T.translation() = Eigen::Vector3d(3 * std::cos(angle), 3 * std::sin(angle), 1.2);
    walk.push_back({i * 100 * kMs, T});
  }
  return walk;
}

Eigen::Isometry3d motion(double x, double y, double z, double yaw) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = expSo3({0.2, -0.1, yaw});
  T.translation() = Eigen::Vector3d(x, y, z);
  return T;
}

Trajectory movedBy(const Eigen::Isometry3d& T, Trajectory trajectory) {
  for (auto& pose : trajectory) pose.T_world_camera = T * pose.T_world_camera;
  return trajectory;
}

/// From pose `first` on, the estimate is off by `shift` in the world.
Trajectory slidden(Trajectory trajectory, std::size_t first, const Eigen::Vector3d& shift) {
  for (std::size_t i = first; i < trajectory.size(); ++i) {
    trajectory[i].T_world_camera.pretranslate(shift);
  }
  return trajectory;
}

TrackFacts factsOf(const Trajectory& truth) {
  TrackFacts facts;
  for (const auto& pose : truth) facts.frames_ns.push_back(pose.stamp_ns);
  return facts;
}

TEST(WrongPoses, NoneOfTheTruthInAnyFrame) {
  EXPECT_TRUE(wrongPoses(circle(), movedBy(motion(5, -2, 1, 2.0), circle())).empty());
}

TEST(WrongPoses, ASlideIsFoundForTheSecondAfterIt) {
  const Trajectory estimate = slidden(circle(), 100, {0.15, 0, 0});
  const auto wrong = wrongPoses(circle(), estimate);
  ASSERT_EQ(wrong.size(), 10U) << "later, both ends of the second have slid";
  EXPECT_EQ(wrong.front(), 100U);
  EXPECT_EQ(wrong.back(), 109U);
  EXPECT_TRUE(wrongPoses(circle(), slidden(circle(), 100, {0.09, 0, 0})).empty());
}

TEST(WrongPoses, DoNotChangeWithTheFrameOfEitherTrajectory) {
  const Trajectory truth = circle(), estimate = slidden(circle(), 60, {0, 0.1, 0.1});
  const auto wrong = wrongPoses(truth, estimate);
  EXPECT_FALSE(wrong.empty());
  EXPECT_EQ(wrongPoses(truth, movedBy(motion(1, 2, 3, 1), estimate)), wrong);
  EXPECT_EQ(wrongPoses(movedBy(motion(-4, 0, 1, -2), truth), estimate), wrong);
}

TEST(WrongPoses, ATurnIsFoundAndDriftIsNot) {
  Trajectory turned = circle();
  for (std::size_t i = 50; i < turned.size(); ++i) {
    turned[i].T_world_camera = turned[i].T_world_camera * motion(0, 0, 0, 0.0);
  }
  EXPECT_FALSE(wrongPoses(circle(), turned).empty()) << "0.22 rad at once";
  Trajectory drifted = circle();
  for (std::size_t i = 0; i < drifted.size(); ++i) {
    drifted[i].T_world_camera.pretranslate(
        Eigen::Vector3d(0.008 * static_cast<double>(i), 0, 0));  // 8 cm a second, 1.6 m in the end
  }
  EXPECT_TRUE(wrongPoses(circle(), drifted).empty());
}

TEST(WrongPoses, AcrossAGapTheLastPoseBeforeItIsCompared) {
  Trajectory estimate = slidden(circle(), 100, {0.15, 0, 0});
  estimate.erase(estimate.begin() + 90, estimate.begin() + 130);  // four seconds without a pose
  const auto wrong = wrongPoses(circle(), estimate);
  ASSERT_EQ(wrong.size(), 10U);
  EXPECT_EQ(wrong.front(), 90U);
}

TEST(WrongPoses, ATruthAtOtherTimesIsInterpolated) {
  Trajectory truth = circle(), estimate = circle();
  for (auto& pose : truth) pose.stamp_ns += 15 * kMs;  // as if all happened 15 ms later
  EXPECT_TRUE(wrongPoses(truth, estimate).empty());
  const auto far = [](Trajectory t) {
    for (auto& pose : t) pose.stamp_ns += 50 * kMs;
    return t;
  };
  EXPECT_TRUE(wrongPoses(far(truth), slidden(estimate, 100, {5, 0, 0})).empty())
      << "nothing is known of poses whose truth is far in time";
}

TEST(Coverage, CountsAllFramesAndTheSharpOnes) {
  Trajectory estimate = circle();
  estimate.erase(estimate.begin() + 10, estimate.begin() + 20);
  TrackFacts facts = factsOf(circle());
  EXPECT_DOUBLE_EQ(coverageOf(estimate, facts).share(), 0.95);
  EXPECT_DOUBLE_EQ(coverageOf(estimate, facts).sharpShare(), 0.95);
  for (int i = 10; i < 18; ++i) facts.blurred_ns.push_back(i * 100 * kMs);
  facts.blurred_ns.push_back(50 * 100 * kMs);  // blurred, and yet it has a pose
  const PoseCoverage coverage = coverageOf(estimate, facts);
  EXPECT_EQ(coverage.posed, 190U);
  EXPECT_EQ(coverage.sharp_frames, 191U);
  EXPECT_EQ(coverage.sharp_posed, 189U);
  EXPECT_DOUBLE_EQ(coverageOf({}, {}).share(), 1.0);
}

TEST(PlaceErrors, AnEndThatIsOffIsAllOfTheErrorAndNoneOfItIsSharedOut) {
  const Trajectory truth = circle();
  const Trajectory estimate = movedBy(motion(3, 1, 0, 1), slidden(circle(), 180, {0, 0.2, 0}));
  const PlaceErrors errors = placeErrors(truth, estimate);
  EXPECT_EQ(errors.distance_m.count, 200U);
  EXPECT_NEAR(errors.distance_m.max, 0.2, 1e-9);
  EXPECT_NEAR(errors.distance_m.rmse, 0.2 * std::sqrt(20.0 / 200.0), 1e-9);
  EXPECT_NEAR(errors.worst_deg, 0.0, 1e-6);
  EXPECT_EQ(errors.false_count, 20U);
  const auto pairs = matchPoses(truth, estimate);
  EXPECT_LT(absoluteError(pairs, align(pairs, false)).max, 0.19)
      << "the best fit gives the others a part of it";
  EXPECT_EQ(placeErrors(truth, slidden(circle(), 180, {0, 0.09, 0})).false_count, 0U);
}

TEST(PlaceErrors, CountDriftThatNoMotionOverASecondShows) {
  Trajectory drifted = circle();
  for (std::size_t i = 0; i < drifted.size(); ++i) {
    drifted[i].T_world_camera.pretranslate(Eigen::Vector3d(0.008 * static_cast<double>(i), 0, 0));
  }
  EXPECT_TRUE(wrongPoses(circle(), drifted).empty());
  const PlaceErrors errors = placeErrors(circle(), drifted);
  EXPECT_GT(errors.false_count, 180U);
  EXPECT_GT(errors.distance_m.max, 1.5);
}

TEST(PlaceErrors, ATurnOnTheSpotCounts) {
  Trajectory turned = circle();
  const double six_deg = 6.0 * M_PI / 180.0;
  for (std::size_t i = 150; i < turned.size(); ++i) {
    turned[i].T_world_camera.linear() *= expSo3({0, 0, six_deg});
  }
  const PlaceErrors errors = placeErrors(circle(), turned);
  EXPECT_EQ(errors.false_count, 50U);
  EXPECT_NEAR(errors.distance_m.max, 0.0, 1e-9);
  EXPECT_NEAR(errors.worst_deg, 6.0, 1e-6);
}

TEST(PlaceErrors, AJumpAtTheTimeIsInTheLiveTrajectoryAlone) {
  // For three seconds the reported poses were 0.3 m off; a loop has corrected that since.
  const Trajectory truth = circle();
  Trajectory live = truth;
  for (std::size_t i = 80; i < 110; ++i) {
    live[i].T_world_camera.pretranslate(Eigen::Vector3d(0, 0, 0.3));
  }
  EXPECT_EQ(placeErrors(truth, truth).false_count, 0U);
  EXPECT_EQ(placeErrors(truth, live).false_count, 30U);
  EXPECT_EQ(wrongPoses(truth, live).size(), 20U) << "a second from the jump, a second from the end";
}

TEST(PlaceErrors, NeedATruthAndBeginWhereThereIsOne) {
  Trajectory truth = circle();
  truth.erase(truth.begin(), truth.begin() + 50);
  const Trajectory estimate = slidden(circle(), 40, {0.5, 0, 0});
  EXPECT_EQ(placeErrors(truth, estimate).false_count, 0U) << "it slid before anything was known";
  EXPECT_EQ(placeErrors(truth, estimate).distance_m.count, 150U);
  EXPECT_THROW(placeErrors({}, estimate), InputError);
}

TEST(HeldError, IsThatOfThePosesWhereThereIsNoGap) {
  const Trajectory truth = circle(), estimate = slidden(circle(), 100, {0.2, 0, 0.1});
  const auto pairs = matchPoses(truth, estimate);
  const Alignment alignment = align(pairs, false);
  const auto held = heldError(truth, estimate, factsOf(truth).frames_ns, alignment);
  EXPECT_EQ(held.count, 200U);
  EXPECT_NEAR(held.rmse, absoluteError(pairs, alignment).rmse, 1e-12);
}

TEST(HeldError, AGapCostsTheWayThatWasNotSeen) {
  const Trajectory truth = circle();
  Trajectory estimate = circle();
  estimate.resize(100);  // lost for good half way
  const auto pairs = matchPoses(truth, estimate);
  const Alignment alignment = align(pairs, false);
  EXPECT_NEAR(absoluteError(pairs, alignment).rmse, 0, 1e-9);
  const auto held = heldError(truth, estimate, factsOf(truth).frames_ns, alignment);
  EXPECT_EQ(held.count, 200U);
  const double farthest = 2 * 3.0 * std::sin(0.5 * 0.03 * 100);
  EXPECT_NEAR(held.max, farthest, 0.02);
  EXPECT_GT(held.rmse, 1.0);
}

TEST(LastError, IsThatOfTheLastPoseWithATruth) {
  Trajectory estimate = slidden(circle(), 199, {0, 0.3, 0});
  EXPECT_NEAR(lastError(circle(), estimate, {}), 0.3, 1e-12);
  estimate.push_back({100'000 * kMs, Eigen::Isometry3d::Identity()});
  EXPECT_NEAR(lastError(circle(), estimate, {}), 0.3, 1e-12);
  EXPECT_EQ(lastError({}, estimate, {}), 0.0);
}

}  // namespace
}  // namespace pf
