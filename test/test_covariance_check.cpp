// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <random>

#include "posefusion/evaluation/covariance_check.hpp"
#include "random_pose.hpp"

namespace pf {
namespace {

constexpr int kPoses = 4000;

/// Standard deviations of the six axes of one step, all different.
Vector6d sigmas() {
  Vector6d s;
  s << 0.001, 0.002, 0.004, 0.001, 0.0005, 0.002;
  return s;
}

struct Walk {
  Trajectory truth;
  std::vector<UncertainPose> poses;
};

/// A dead reckoning whose every step is off by normal noise of `noise` * sigmas().
Walk walk(double noise, std::int64_t step_ms = 33) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Walk walk;
  Vector6d step;
  step << 0.01, 0.002, 0.02, 0.001, 0.02, 0.003;
  Eigen::Isometry3d Q = Eigen::Isometry3d::Identity(), P = expSe3(10 * step);
  for (int i = 0; i < kPoses; ++i) {
    const std::int64_t stamp_ns = i * step_ms * kMs;
    walk.truth.push_back({stamp_ns, Q});
    walk.poses.push_back({stamp_ns, P, sigmas().cwiseAbs2().asDiagonal()});
    Vector6d error;
    for (int axis = 0; axis < 6; ++axis) error[axis] = noise * sigmas()[axis] * normal(random);
    Q = Q * expSe3(step);
    P = P * expSe3(step) * expSe3(error);
  }
  return walk;
}

TEST(CovarianceCheck, ACorrectCovarianceHoldsTheShareOfANormalError) {
  const Walk w = walk(1.0);
  const CovarianceShare share = checkCovariances(w.truth, w.poses);
  EXPECT_EQ(share.motions, static_cast<std::size_t>(kPoses - 1));
  for (const double axis : share.axes) EXPECT_NEAR(axis, 0.9973, 0.004);
  EXPECT_NEAR(share.within, std::pow(0.9973, 6), 0.006);
  EXPECT_NEAR(share.within_ellipsoid, 0.9973, 0.004);
  EXPECT_NEAR(share.median_sigmas, 1.6, 0.15);
}

TEST(CovarianceCheck, TooSureIsFound) {
  const Walk w = walk(10.0);
  const CovarianceShare share = checkCovariances(w.truth, w.poses);
  EXPECT_LT(share.within, 0.01);
  EXPECT_LT(share.within_ellipsoid, 0.05);
  EXPECT_GT(share.median_sigmas, 10);
}

TEST(CovarianceCheck, OneAxisTooSureIsFound) {
  Walk w = walk(1.0);
  for (auto& pose : w.poses) pose.covariance(4, 4) *= 1e-4;
  const CovarianceShare share = checkCovariances(w.truth, w.poses);
  EXPECT_LT(share.axes[4], 0.05);
  EXPECT_GT(share.axes[3], 0.99);
  EXPECT_LT(share.within, 0.05);
}

TEST(CovarianceCheck, DoesNotChangeWithTheFrameOfTheMap) {
  Walk w = walk(3.0);
  const CovarianceShare before = checkCovariances(w.truth, w.poses);
  Vector6d far;
  far << 3, -5, 1, 0.3, 2, -0.4;
  for (auto& pose : w.poses) pose.T_map_camera = expSe3(far) * pose.T_map_camera;
  EXPECT_DOUBLE_EQ(checkCovariances(w.truth, w.poses).within, before.within);
}

TEST(CovarianceCheck, NoCovarianceHoldsNoError) {
  Walk w = walk(1.0);
  for (auto& pose : w.poses) pose.covariance.setZero();
  EXPECT_EQ(checkCovariances(w.truth, w.poses).within, 0.0);
  EXPECT_EQ(checkCovariances(w.truth, w.poses).within_ellipsoid, 0.0);
}

TEST(CovarianceCheck, LongGapsAndMissingTruthAreLeftOut) {
  const Walk slow = walk(1.0, 600);
  EXPECT_EQ(checkCovariances(slow.truth, slow.poses).motions, 0U);
  EXPECT_EQ(checkCovariances({}, slow.poses).motions, 0U);
  Walk w = walk(1.0);
  w.truth.erase(w.truth.begin() + 100, w.truth.begin() + 200);
  EXPECT_EQ(checkCovariances(w.truth, w.poses).motions, static_cast<std::size_t>(kPoses - 102));
}

/// Provisional poses that are off by 0.1 m, in a map that lies anywhere in the truth.
TEST(ProvisionalCheck, CountsThoseWithinTheirOwnSigmas) {
  Trajectory truth, known;
  std::vector<UncertainPose> provisional;
  Vector6d anywhere;
  anywhere << 3, -1, 2, 0.3, -0.5, 1;
  const Eigen::Isometry3d T_map_truth = expSe3(anywhere);
  for (int i = 0; i < 40; ++i) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() << 0.1 * i, std::sin(0.2 * i), 0.01 * i * i;
    const std::int64_t stamp_ns = 33'000'000LL * (i + 1);
    truth.push_back({stamp_ns, T});
    if (i < 20) {
      known.push_back({stamp_ns, T_map_truth * T});
      continue;
    }
    Eigen::Isometry3d off = T_map_truth * T;
    off.translation() += 0.1 * Eigen::Vector3d::UnitX();
    const double sigma_m = i < 30 ? 0.05 : 0.02;
    provisional.push_back({stamp_ns, off, independentCovariance(sigma_m, 0.01)});
  }
  const ProvisionalShare share = checkProvisional(truth, known, provisional);
  EXPECT_EQ(share.poses, 20U);
  EXPECT_NEAR(share.within, 0.5, 1e-9);
  EXPECT_NEAR(share.median_m, 0.1, 1e-6);
  EXPECT_NEAR(share.most_m, 0.1, 1e-6);
  EXPECT_EQ(checkProvisional(truth, {}, provisional).poses, 0U)
      << "the place of the map is unknown";
}

}  // namespace
}  // namespace pf
