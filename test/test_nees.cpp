// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "posefusion/evaluation/nees.hpp"
#include "random_pose.hpp"

namespace pf {
namespace {

constexpr int kSteps = 12'000;  // 400 s

Vector6d trueSigmas() {
  Vector6d s;
  s << 0.001, 0.002, 0.004, 0.001, 0.0005, 0.002;
  return s;
}

struct NoisyWalk {
  Trajectory truth;
  std::vector<UncertainPose> poses;
};

/// A walk whose poses are each off by normal noise of trueSigmas(); reported are `said` *
/// trueSigmas().
NoisyWalk noisyWalk(double said) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Vector6d step;
  step << 0.01, 0.002, 0.02, 0.001, 0.02, 0.003;
  Vector6d far;
  far << 3, -5, 1, 0.3, 2, -0.4;
  const Eigen::Isometry3d T_map_world = expSe3(far);
  NoisyWalk walk;
  Eigen::Isometry3d Q = Eigen::Isometry3d::Identity();
  for (int i = 0; i < kSteps; ++i) {
    Vector6d error;
    for (int axis = 0; axis < 6; ++axis) error[axis] = trueSigmas()[axis] * normal(random);
    const std::int64_t stamp_ns = i * 100 * kMs / 3;
    walk.truth.push_back({stamp_ns, Q});
    walk.poses.push_back({stamp_ns, T_map_world * Q * expSe3(error),
                          (said * trueSigmas()).cwiseAbs2().asDiagonal()});
    Q = Q * expSe3(step);
  }
  return walk;
}

TEST(ChiSquare, QuantilesAreThoseOfTheTables) {
  EXPECT_NEAR(chiSquareQuantile(6, 0.025), 1.237, 0.001);
  EXPECT_NEAR(chiSquareQuantile(6, 0.975), 14.449, 0.001);
  EXPECT_NEAR(chiSquareQuantile(6, 0.9973), 20.062, 0.001);
  EXPECT_NEAR(chiSquareQuantile(30, 0.025), 16.791, 0.001);
  EXPECT_NEAR(chiSquareQuantile(30, 0.975), 46.979, 0.001);
  EXPECT_NEAR(chiSquareQuantile(2, 0.5), 2.0 * std::log(2.0), 1e-9);
}

class Nees : public testing::TestWithParam<std::size_t> {};

TEST_P(Nees, ACorrectCovarianceIsInTheBandAsOftenAsExpected) {
  const NoisyWalk r = noisyWalk(1.0);
  const NeesShare share = neesOfMotions(r.truth, r.poses, GetParam());
  EXPECT_NEAR(share.mean, 6.0, 0.2);
  EXPECT_NEAR(share.median, 5.35, 0.2);
  for (const double axis : share.axes) EXPECT_NEAR(axis, 1.0, 0.05);
  EXPECT_NEAR(share.inside, 0.95, 0.025);
  EXPECT_NEAR(share.too_low, 0.025, 0.02);
  EXPECT_NEAR(share.too_high, 0.025, 0.02);
  EXPECT_NEAR(
      share.low,
      chiSquareQuantile(6 * static_cast<int>(GetParam()), 0.025) / static_cast<double>(GetParam()),
      1e-9);
}

TEST_P(Nees, HalfTheSigmasAreTooSure) {
  const NoisyWalk r = noisyWalk(0.5);
  const NeesShare share = neesOfMotions(r.truth, r.poses, GetParam());
  EXPECT_NEAR(share.mean, 24.0, 0.8);
  EXPECT_LT(share.inside, GetParam() > 1 ? 0.05 : 0.35);
  EXPECT_GT(share.too_high, 0.7);
  EXPECT_LT(share.too_low, 0.001);
}

TEST_P(Nees, TwiceTheSigmasAreTooCautious) {
  const NoisyWalk r = noisyWalk(2.0);
  const NeesShare share = neesOfMotions(r.truth, r.poses, GetParam());
  EXPECT_NEAR(share.mean, 1.5, 0.05);
  EXPECT_LT(share.inside, GetParam() > 1 ? 0.05 : 0.6);
  EXPECT_GT(share.too_low, 0.4) << "what a check of three sigmas alone calls perfect";
  EXPECT_EQ(share.too_high, 0.0);
}

INSTANTIATE_TEST_SUITE_P(Windows, Nees, testing::Values(1U, 5U));

TEST(NeesOfMotions, IsTheSameInAnyFrameOfTheMap) {
  NoisyWalk r = noisyWalk(1.0);
  const NeesShare before = neesOfMotions(r.truth, r.poses, 5);
  Vector6d far;
  far << -2, 1, 4, 1.3, -0.2, 0.4;
  for (auto& pose : r.poses) pose.T_map_camera = expSe3(far) * pose.T_map_camera;
  EXPECT_NEAR(neesOfMotions(r.truth, r.poses, 5).mean, before.mean, 1e-6);
}

TEST(NeesOfMotions, TheAxisThatIsTooSureIsNamed) {
  NoisyWalk r = noisyWalk(1.0);
  for (auto& pose : r.poses) pose.covariance(1, 1) /= 9.0;
  const NeesShare share = neesOfMotions(r.truth, r.poses, 5);
  EXPECT_GT(share.axes[1], 2.0);
  EXPECT_NEAR(share.axes[3], 1.0, 0.05);
  EXPECT_GT(share.too_high, 0.5);
}

TEST(NeesOfMotions, GapsBreakWindowsAndWithoutATruthThereAreNone) {
  NoisyWalk r = noisyWalk(1.0);
  EXPECT_EQ(neesOfMotions({}, r.poses, 1).windows, 0U);
  EXPECT_EQ(neesOfMotions({}, r.poses, 1).inside, 0.0);
  const NeesShare whole = neesOfMotions(r.truth, r.poses, 5);
  EXPECT_EQ(whole.motions, static_cast<std::size_t>(kSteps - 30));
  EXPECT_EQ(whole.windows, static_cast<std::size_t>(kSteps - 5 * 30 - 4));
  r.poses.erase(r.poses.begin() + 6000, r.poses.begin() + 6060);  // two seconds
  const NeesShare broken = neesOfMotions(r.truth, r.poses, 5);
  EXPECT_EQ(broken.motions, whole.motions - 60 - 30);
  EXPECT_LT(broken.windows, whole.windows - 60 - 100);
}

TEST(NeesOfMotions, NoCovarianceIsTooSure) {
  NoisyWalk r = noisyWalk(1.0);
  for (auto& pose : r.poses) pose.covariance.setZero();
  EXPECT_EQ(neesOfMotions(r.truth, r.poses, 5).too_high, 1.0);
}

/// Constraints between keyframes of the walk whose errors are normal noise of trueSigmas().
NeesShare ofConstraints(double said) {
  const NoisyWalk r = noisyWalk(1.0);
  std::mt19937 random(6);
  std::normal_distribution<double> normal;
  std::vector<Keyframe> keyframes;
  std::vector<PoseConstraint> constraints;
  for (int i = 0; i < 4000; ++i) {
    Keyframe keyframe;
    keyframe.id = i;
    keyframe.stamp_ns = r.truth[static_cast<std::size_t>(i)].stamp_ns;
    keyframes.push_back(keyframe);
    PoseConstraint c;
    c.from = i / 2;
    c.to = i;
    Vector6d error;
    for (int axis = 0; axis < 6; ++axis) error[axis] = trueSigmas()[axis] * normal(random);
    c.T_from_to = r.truth[static_cast<std::size_t>(c.from)].T_world_camera.inverse() *
                  r.truth[static_cast<std::size_t>(c.to)].T_world_camera * expSe3(error);
    c.covariance = (said * trueSigmas()).cwiseAbs2().asDiagonal();
    constraints.push_back(c);
  }
  keyframes.back().stamp_ns += 1'000'000 * kMs;
  return neesOfConstraints(r.truth, keyframes, constraints);
}

TEST(NeesOfConstraints, IsTwoSided) {
  const NeesShare honest = ofConstraints(1.0);
  EXPECT_EQ(honest.windows, 3999U) << "all whose keyframes have a true pose";
  EXPECT_NEAR(honest.mean, 6.0, 0.2);
  EXPECT_NEAR(honest.inside, 0.95, 0.015);
  for (const double axis : honest.axes) EXPECT_NEAR(axis, 1.0, 0.06);
  EXPECT_GT(ofConstraints(0.5).too_high, 0.7);
  EXPECT_GT(ofConstraints(2.0).too_low, 0.4);
}

}  // namespace
}  // namespace pf
