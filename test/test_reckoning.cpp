// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/reckoning.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace pf {
namespace {

const Matrix6d kStep = independentCovariance(0.002, 0.001);

double sigmaM(const ProvisionalPose& pose) {
  return std::sqrt(pose.covariance.diagonal().head<3>().maxCoeff());
}

Eigen::Isometry3d ahead(double metres, double yaw = 0) {
  Vector6d twist;
  twist << 0, 0, metres, 0, yaw, 0;
  return expSe3(twist);
}

TEST(Reckoning, ThereIsNoneBeforeTheCameraWasKnown) {
  Reckoning reckoning;
  reckoning.move(ahead(1), kStep, 0.1);
  reckoning.pass(1);
  EXPECT_FALSE(reckoning.pose());
  reckoning.know(ahead(2), kStep);
  ASSERT_TRUE(reckoning.pose());
  EXPECT_TRUE(reckoning.pose()->T_map_camera.isApprox(ahead(2)));
  reckoning.reset();
  EXPECT_FALSE(reckoning.pose());
}

TEST(Reckoning, GoesOnByItsSteps) {
  Reckoning reckoning;
  reckoning.know(ahead(2), kStep);
  Eigen::Isometry3d T = ahead(2);
  double before_m = 0;
  for (int i = 0; i < 200; ++i) {
    reckoning.move(ahead(0.01, 0.01), kStep, 0.1);
    T = T * ahead(0.01, 0.01);
    EXPECT_GT(sigmaM(*reckoning.pose()), before_m);
    before_m = sigmaM(*reckoning.pose());
  }
  EXPECT_TRUE(reckoning.pose()->T_map_camera.isApprox(T, 1e-9));
  EXPECT_LT(before_m, 0.3) << "two metres of way";
  reckoning.know(T, kStep);
  EXPECT_NEAR(sigmaM(*reckoning.pose()), 0.002, 1e-9) << "known again";
}

TEST(Reckoning, WithoutMeasurementsTheErrorGrowsWithTheTimeAndStays) {
  Reckoning often, once;
  for (Reckoning* reckoning : {&often, &once}) reckoning->know(ahead(0), kStep);
  for (int i = 0; i < 30; ++i) often.pass(1.0 / 30);
  once.pass(1);
  EXPECT_NEAR(sigmaM(*often.pose()), sigmaM(*once.pose()), 1e-9) << "whatever the rate";
  EXPECT_GT(sigmaM(*once.pose()), 0.5);
  once.move(ahead(0.01), kStep, 0.1);
  EXPECT_GT(sigmaM(*once.pose()), 0.5) << "motion without measurements is not known afterwards";
  for (int i = 0; i < 100; ++i) once.pass(1);
  EXPECT_LT(std::sqrt(once.pose()->covariance(3, 3)), M_PI) << "no more than all around";
}

TEST(Reckoning, FollowsCorrectionsOfTheMap) {
  Reckoning reckoning;
  reckoning.know(ahead(2), kStep);
  reckoning.move(ahead(1), kStep, 0.1);
  const Matrix6d before = reckoning.pose()->covariance;
  reckoning.correct(ahead(-0.5, 0.2));
  EXPECT_TRUE(reckoning.pose()->T_map_camera.isApprox(ahead(-0.5, 0.2) * ahead(3), 1e-9));
  EXPECT_EQ(reckoning.pose()->covariance, before) << "as seen from the camera";
}

/// Steps with random errors of their covariance: the reported ellipsoid holds the true pose.
TEST(Reckoning, TheCovarianceCoversErrorsOfTheSteps) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  int within = 0;
  for (int run = 0; run < 100; ++run) {
    Reckoning reckoning;
    Eigen::Isometry3d T = ahead(0);
    reckoning.know(T, kStep);
    for (int i = 0; i < 50; ++i) {
      Vector6d error;
      for (int k = 0; k < 6; ++k) error[k] = (k < 3 ? 0.002 : 0.001) * normal(random);
      const Eigen::Isometry3d step = ahead(0.01, 0.02);
      T = T * step;
      reckoning.move(step * expSe3(error), kStep, 0.1);
    }
    const ProvisionalPose pose = *reckoning.pose();
    const Vector6d off = logSe3(T.inverse() * pose.T_map_camera);
    within += (off.array().abs() < 3 * pose.covariance.diagonal().array().sqrt()).all() ? 1 : 0;
  }
  EXPECT_GE(within, 95);
}

}  // namespace
}  // namespace pf
