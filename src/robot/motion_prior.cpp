// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/robot/motion_prior.hpp"

#include "posefusion/core/symmetric.hpp"

namespace pf {
namespace {

constexpr double kMostChiSquare = 22.46;

}  // namespace

std::optional<MotionPrior> combined(const MotionPrior& a, const MotionPrior& b) {
  const Vector6d difference = logSe3(a.T_before_after.inverse() * b.T_before_after);
  const Matrix6d sum = a.covariance + b.covariance;
  if (!(mahalanobis2(difference, sum) <= kMostChiSquare)) return std::nullopt;
  // As a Kalman filter takes a measurement of the whole state in.
  const Matrix6d gain = solve(sum, a.covariance).transpose();
  MotionPrior both;
  both.T_before_after = orthonormalised(a.T_before_after * expSe3(gain * difference));
  const Matrix6d left = a.covariance - gain * a.covariance;
  both.covariance = 0.5 * (left + left.transpose());
  both.has_shift = a.has_shift || b.has_shift;
  return both;
}

}  // namespace pf
