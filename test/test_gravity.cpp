// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/robot/gravity.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "posefusion/core/se3.hpp"
#include "posefusion/core/trajectory.hpp"

namespace pf {
namespace {

TEST(GravityEstimate, StepsOfAWalkHaveNoMean) {
  const Eigen::Vector3d up = expSo3({0.1, 0, 0.07}) * Eigen::Vector3d(0, -1, 0);
  GravityEstimate gravity;
  for (double s = 0; s < 10; s += 0.033) {
    if (s < 5) EXPECT_FALSE(gravity.up());
    const Eigen::Vector3d walk(3 * std::sin(9 * s), 4 * std::cos(12 * s), s < 0.5 ? 1.0 : 0.0);
    gravity.add(9.81 * up + walk, 0.033);
  }
  ASSERT_TRUE(gravity.up());
  EXPECT_LT(std::acos(gravity.up()->dot(up)), 0.5 * M_PI / 180);
}

TEST(GravityEstimate, WhatIsNotGravityIsIgnored) {
  GravityEstimate in_g, silent;
  for (int i = 0; i < 300; ++i) {
    in_g.add({0, -1, 0}, 0.033);
    silent.add(Eigen::Vector3d::Zero(), 0.033);
  }
  EXPECT_FALSE(in_g.up());
  EXPECT_FALSE(silent.up());
}

TEST(LevelFromOptical, TurnsUpUpAndKeepsTheHeading) {
  EXPECT_TRUE(levelFromOptical({0, -1, 0}).isApprox(bodyFromOptical(), 1e-12)) << "a level camera";
  for (const Eigen::Vector3d& tilt : {Eigen::Vector3d(0.3, 0, 0), Eigen::Vector3d(0.2, 0, -0.4),
                                      Eigen::Vector3d(-M_PI / 2, 0, 0)}) {
    const Eigen::Vector3d up = expSo3(tilt) * Eigen::Vector3d(0, -1, 0);
    const Eigen::Isometry3d T = levelFromOptical(up);
    EXPECT_TRUE(isRigid(T));
    EXPECT_TRUE((T.linear() * up).isApprox(Eigen::Vector3d::UnitZ(), 1e-9));
    const Eigen::Vector3d ahead = T.linear() * Eigen::Vector3d::UnitZ();
    EXPECT_NEAR(ahead.y(), 0, 1e-9) << "the way that the camera looks";
    EXPECT_GE(ahead.x(), -1e-9);
  }
}

}  // namespace
}  // namespace pf
