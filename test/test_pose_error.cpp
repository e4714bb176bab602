// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/graph/constraint.hpp"

#include <gtest/gtest.h>

#include <random>

#include "graph_scene.hpp"

namespace pf {
namespace {

TEST(PoseError, ItsAnalyticDerivativesAreTheNumericOnes) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto twist = [&](double size) {
    Vector6d t;
    for (int i = 0; i < 6; ++i) t[i] = size * normal(random);
    return t;
  };
  constexpr double kStep = 1e-6;
  for (const double off : {0.0, 1e-4, 0.1, 0.6}) {
    const Eigen::Isometry3d from = expSe3(twist(1)), to = expSe3(twist(1));
    const Eigen::Isometry3d measured = from.inverse() * to * expSe3(twist(off));
    const PoseError error = poseError(from, to, measured);
    for (int k = 0; k < 6; ++k) {
      const Vector6d d = kStep * Vector6d::Unit(k);
      const Vector6d by_from = poseError(from * expSe3(d), to, measured).twist -
                               poseError(from * expSe3(-d), to, measured).twist;
      const Vector6d by_to = poseError(from, to * expSe3(d), measured).twist -
                             poseError(from, to * expSe3(-d), measured).twist;
      EXPECT_LT((error.by_from.col(k) - by_from / (2 * kStep)).norm(), 1e-7) << off << ' ' << k;
      EXPECT_LT((error.by_to.col(k) - by_to / (2 * kStep)).norm(), 1e-7) << off << ' ' << k;
    }
  }
}

TEST(PoseError, ChiSquareCountsVariancesInTheLaterCamera) {
  PoseConstraint c;
  c.covariance.diagonal() << 0.01, 0.04, 0.01, 0.01, 0.01, 0.01;
  const Eigen::Isometry3d from = motion(1, 2, 3, 0.5), to = from * motion(0.1, 0.4, 0, 0);
  EXPECT_NEAR(chiSquare(c, from, to), 1 + 4, 1e-9);
}

}  // namespace
}  // namespace pf
