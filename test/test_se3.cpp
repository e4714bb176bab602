// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <random>

#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

Vector6d randomTwist(std::mt19937& random, double angle) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Vector6d twist;
  for (int i = 0; i < 6; ++i) twist[i] = unit(random);
  twist.tail<3>() *= angle / twist.tail<3>().norm();
  return twist;
}

TEST(Se3, LogInvertsExpFromTinyAnglesToAlmostPi) {
  std::mt19937 random(1);
  for (const double angle : {1e-12, 1e-7, 1e-5, 1e-3, 0.1, 1.0, 2.0, 3.1, 3.1415}) {
    const Vector6d twist = randomTwist(random, angle);
    EXPECT_LT((logSe3(expSe3(twist)) - twist).norm(), 1e-8) << "angle " << angle;
  }
}

TEST(Se3, ExpIsARigidMotion) {
  std::mt19937 random(2);
  for (const double angle : {1e-9, 1e-4, 0.5, 3.0}) {
    const Eigen::Matrix3d R = expSe3(randomTwist(random, angle)).linear();
    EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-9);
    EXPECT_NEAR(R.determinant(), 1.0, 1e-9);
  }
}

TEST(Se3, ExpOfATwistAndItsOppositeCancel) {
  std::mt19937 random(3);
  const Vector6d twist = randomTwist(random, 0.7);
  const Eigen::Isometry3d T = expSe3(twist) * expSe3(-twist);
  EXPECT_LT((T.matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-12);
}

TEST(Se3, OrthonormalisedRepairsADriftedRotation) {
  Eigen::Isometry3d T = expSe3(Vector6d::Constant(0.3));
  T.linear() *= 1.0001;
  const Eigen::Matrix3d R = orthonormalised(T).linear();
  EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

TEST(Se3, LeftJacobianIsTheDerivativeOfExp) {
  std::mt19937 random(4);
  constexpr double kStep = 1e-6;
  for (const double angle : {1e-9, 1e-3, 0.1, 0.2999, 0.3001, 1.0, 2.5, 3.1}) {
    const Vector6d twist = randomTwist(random, angle);
    const Matrix6d J = leftJacobianSe3(twist);
    for (int k = 0; k < 6; ++k) {
      const Vector6d d = kStep * Vector6d::Unit(k);
      const Vector6d numeric =
          logSe3(expSe3(twist + d) * expSe3(twist - d).inverse()) / (2 * kStep);
      EXPECT_LT((J.col(k) - numeric).norm(), 1e-7) << "angle " << angle << ", column " << k;
    }
  }
}

TEST(Se3, AdjointMovesATwistToAnotherFrame) {
  Vector6d pose, twist;
  pose << 0.3, -0.2, 1.5, 0.4, 0.7, -0.3;
  twist << 0.01, 0.02, -0.03, 0.02, -0.01, 0.015;
  const Eigen::Isometry3d T = expSe3(pose);
  const Eigen::Isometry3d expected = T * expSe3(twist) * T.inverse();
  EXPECT_TRUE(expSe3(adjoint(T) * twist).isApprox(expected, 1e-12));
}

}  // namespace
}  // namespace pf
