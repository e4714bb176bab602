// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/se3.hpp"

#include <cmath>

namespace pf {
namespace {

// Coefficients of the exponential series; below this angle the Taylor form is exact to rounding.
constexpr double kSmallAngle = 1e-5;

/// V of exp: translation = V * v.
Eigen::Matrix3d leftJacobian(const Eigen::Vector3d& omega) {
  const double angle = omega.norm();
  const Eigen::Matrix3d W = hat(omega);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + 0.5 * W + W * W / 6.0;
  const double a2 = angle * angle;
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / a2 * W +
         (angle - std::sin(angle)) / (a2 * angle) * W * W;
}

}  // namespace

Eigen::Matrix3d hat(const Eigen::Vector3d& w) {
  Eigen::Matrix3d W;
  W << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return W;
}

Eigen::Matrix3d expSo3(const Eigen::Vector3d& omega) {
  const double angle = omega.norm();
  const Eigen::Matrix3d W = hat(omega);
  if (angle < kSmallAngle) return Eigen::Matrix3d::Identity() + W + 0.5 * W * W;
  return Eigen::Matrix3d::Identity() + std::sin(angle) / angle * W +
         (1.0 - std::cos(angle)) / (angle * angle) * W * W;
}

Eigen::Vector3d logSo3(const Eigen::Matrix3d& rotation) {
  // Through the quaternion: well conditioned everywhere, also near pi.
  Eigen::Quaterniond q(rotation);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine < kSmallAngle) return 2.0 * q.vec();
  return 2.0 * std::atan2(sine, q.w()) / sine * q.vec();
}

Eigen::Isometry3d expSe3(const Vector6d& twist) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = expSo3(twist.tail<3>());
  T.translation() = leftJacobian(twist.tail<3>()) * twist.head<3>();
  return T;
}

Vector6d logSe3(const Eigen::Isometry3d& T) {
  Vector6d twist;
  twist.tail<3>() = logSo3(T.linear());
  twist.head<3>() = leftJacobian(twist.tail<3>()).inverse() * T.translation();
  return twist;
}

Matrix6d adjoint(const Eigen::Isometry3d& T) {
  Matrix6d A = Matrix6d::Zero();
  A.topLeftCorner<3, 3>() = A.bottomRightCorner<3, 3>() = T.linear();
  A.topRightCorner<3, 3>() = hat(T.translation()) * T.linear();
  return A;
}

Eigen::Isometry3d orthonormalised(const Eigen::Isometry3d& T) {
  Eigen::Isometry3d out = T;
  out.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return out;
}

}  // namespace pf
