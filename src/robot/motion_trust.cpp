// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/robot/motion_trust.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace pf {
namespace {

// Odds (natural logarithm) at which a source is believed, and beyond which nothing is added: it
// takes two contradictions in a row to lose them.
constexpr double kBelieved = 10.0, kMost = 25.0;
// Frames in a row have errors in common: one says less for a source than its own likelihood, and
// may say a lot against it.
constexpr double kMostFor = 1.0, kMostAgainst = 10.0;
constexpr double kMemory = 100;        // frames
constexpr double kMostSquare = 22.46;  // of one frame: a contradiction is no noise

/// Minus twice the logarithm of a normal density, up to a constant.
double surprise(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  const Eigen::LLT<Eigen::Matrix3d> root(covariance);
  return error.dot(root.solve(error)) +
         2.0 * Eigen::Matrix3d(root.matrixLLT()).diagonal().array().log().sum();
}

}  // namespace

void MotionTrust::Half::compare(const Eigen::Vector3d& error, const Eigen::Vector3d& moved,
                                const Eigen::Matrix3d& told, const Eigen::Matrix3d& seen,
                                double anything) {
  const Eigen::Matrix3d sum = spread * told + seen;
  const double nothing = surprise(moved, sum + anything * anything * Eigen::Matrix3d::Identity());
  const double better = std::min(nothing, surprise(moved, sum));
  const double ratio = 0.5 * (better - surprise(error, sum));
  evidence = std::clamp(evidence + std::clamp(ratio, -kMostAgainst, kMostFor), -kMost, kMost);
  const Eigen::Matrix3d promised = told + seen;
  const double square = std::min(error.dot(promised.llt().solve(error)) / 3.0, kMostSquare);
  spread = std::max(1.0, spread + (square - spread) / kMemory);
}

void MotionTrust::compare(const MotionPrior& told, const Eigen::Isometry3d& T_seen,
                          const Matrix6d& covariance, double elapsed_s) {
  const Vector6d error = logSe3(told.T_before_after.inverse() * T_seen);
  const Vector6d moved = logSe3(T_seen);
  has_shift_ = told.has_shift;
  turn_.compare(error.tail<3>(), moved.tail<3>(), told.covariance.bottomRightCorner<3, 3>(),
                covariance.bottomRightCorner<3, 3>(), kRobotTurn_rad_s * elapsed_s);
  if (!has_shift_) return;
  shift_.compare(error.head<3>(), moved.head<3>(), told.covariance.topLeftCorner<3, 3>(),
                 covariance.topLeftCorner<3, 3>(), kRobotSpeed_m_s * elapsed_s);
}

bool MotionTrust::isBelieved() const {
  return turn_.evidence >= kBelieved && (!has_shift_ || shift_.evidence >= kBelieved);
}

MotionPrior MotionTrust::honest(MotionPrior told) const {
  told.covariance.topLeftCorner<3, 3>() *= shift_.spread;
  told.covariance.bottomRightCorner<3, 3>() *= turn_.spread;
  return told;
}

void MotionTrust::doubt() {
  for (Half* half : {&shift_, &turn_}) half->evidence = std::min(half->evidence, 0.0);
}

}  // namespace pf
