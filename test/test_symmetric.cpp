// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "posefusion/core/symmetric.hpp"

namespace pf {
namespace {

/// A covariance with parts as different as those of metres and of radians.
Matrix6d randomCovariance(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Matrix6d A;
  for (int i = 0; i < A.size(); ++i) A(i) = normal(random);
  Vector6d scale;
  scale << 1, 1, 1, 1e-2, 1e-2, 1e-2;
  return scale.asDiagonal() * Matrix6d(A * A.transpose() + Matrix6d::Identity()) *
         scale.asDiagonal();
}

TEST(Symmetric, SolvesVectorsAndColumns) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Matrix6d A = randomCovariance(seed);
    const Vector6d x = Vector6d::LinSpaced(-1, 2);
    EXPECT_LT((solve(A, A * x) - x).norm(), 1e-9);
    EXPECT_LT((inverse(A) * A - Matrix6d::Identity()).norm(), 1e-8);
    SixRows columns(6, 9);
    for (int k = 0; k < 9; ++k) columns.col(k) = k * x;
    EXPECT_LT((solve(A, SixRows(A * columns)) - columns).norm(), 1e-8);
  }
}

TEST(Symmetric, WhitenedErrorsHaveTheMahalanobisDistanceAsLength) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Matrix6d C = randomCovariance(seed), W = whitening(C);
    const Vector6d error = Vector6d::LinSpaced(0.1, 0.2);
    EXPECT_LT((propagated(W, C) - Matrix6d::Identity()).norm(), 1e-9);
    EXPECT_NEAR((W * error).squaredNorm() / mahalanobis2(error, C), 1.0, 1e-9);
  }
}

TEST(Symmetric, WhatIsNotPositiveDefiniteIsFound) {
  Matrix6d C = randomCovariance(1);
  EXPECT_TRUE(isPositiveDefinite(C));
  EXPECT_FALSE(isPositiveDefinite(-C));
  EXPECT_FALSE(isPositiveDefinite(Matrix6d::Zero()));
  C(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(isPositiveDefinite(C));
}

TEST(Symmetric, EigenvaluesRiseAndTheirVectorsMakeTheMatrix) {
  const Eigen::Matrix3d A = randomCovariance(3).topLeftCorner<3, 3>();
  const SymmetricEigen eigen = eigenOf(A);
  EXPECT_LE(eigen.values[0], eigen.values[1]);
  EXPECT_LE(eigen.values[1], eigen.values[2]);
  const Eigen::Matrix3d again =
      eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose();
  EXPECT_LT((again - A).norm(), 1e-12);
}

}  // namespace
}  // namespace pf
