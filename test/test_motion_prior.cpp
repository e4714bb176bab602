// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/robot/motion_prior.hpp"

#include <gtest/gtest.h>

namespace pf {
namespace {

Eigen::Isometry3d motion(double x, double yaw) {
  Vector6d twist;
  twist << x, 0, 0, 0, yaw, 0;
  return expSe3(twist);
}

TEST(MotionPrior, TheSurerOfTwoDecides) {
  const MotionPrior sure{motion(0.1, 0.02), independentCovariance(0.001, 0.001), true};
  const MotionPrior vague{motion(0.13, 0.05), independentCovariance(0.05, 0.05), false};
  for (const bool first : {true, false}) {
    const auto both = first ? combined(sure, vague) : combined(vague, sure);
    ASSERT_TRUE(both);
    EXPECT_TRUE(both->T_before_after.isApprox(sure.T_before_after, 1e-4));
    EXPECT_LE(both->covariance(0, 0), sure.covariance(0, 0));
    EXPECT_TRUE(both->has_shift);
  }
}

TEST(MotionPrior, TwoAlikeAreHalfwayAndSurer) {
  const Matrix6d covariance = independentCovariance(0.01, 0.01);
  const auto both =
      combined({motion(0.10, 0), covariance, true}, {motion(0.12, 0), covariance, true});
  ASSERT_TRUE(both);
  EXPECT_NEAR(both->T_before_after.translation().x(), 0.11, 1e-9);
  EXPECT_TRUE(both->covariance.isApprox(0.5 * covariance, 1e-9));
}

TEST(MotionPrior, WhatContradictsIsNotCombined) {
  const Matrix6d covariance = independentCovariance(0.01, 0.01);
  EXPECT_FALSE(combined({motion(0.1, 0), covariance, true}, {motion(0.3, 0), covariance, true}));
  EXPECT_FALSE(combined({motion(0.1, 0), covariance, true}, {motion(0.1, 0.3), covariance, true}));
}

TEST(MotionPrior, OneOfTheTurnAloneLeavesTheShift) {
  const MotionPrior seen{motion(0.1, 0.02), independentCovariance(0.05, 0.05), true};
  const MotionPrior turn{motion(0, 0.05), independentCovariance(10, 0.0005), false};
  const auto both = combined(seen, turn);
  ASSERT_TRUE(both);
  EXPECT_NEAR(angleOf(both->T_before_after), 0.05, 1e-4);
  EXPECT_NEAR(both->T_before_after.translation().x(), 0.1, 0.003);
  EXPECT_NEAR(both->covariance(0, 0), seen.covariance(0, 0), 1e-4);
}

}  // namespace
}  // namespace pf
