// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/se3.hpp"

#include <cmath>

namespace pf {
namespace {

// Coefficients of the exponential series; below this angle the Taylor form is exact to rounding.
constexpr double kSmallAngle = 1e-5;
// Below this angle so many terms of the left Jacobian's series are exact to rounding.
constexpr double kSeriesAngle = 0.3;
constexpr int kSeriesTerms = 11;

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

Matrix6d leftJacobianSe3(const Vector6d& twist) {
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = ad.bottomRightCorner<3, 3>() = hat(twist.tail<3>());
  ad.topRightCorner<3, 3>() = hat(twist.head<3>());
  const double angle = twist.tail<3>().norm();
  if (angle < kSeriesAngle) {  // the closed form loses digits here: sum of ad^n / (n + 1)!
    Matrix6d sum = Matrix6d::Identity();
    for (int n = kSeriesTerms; n >= 1; --n) sum = Matrix6d::Identity() + ad * sum / (n + 1.0);
    return sum;
  }
  const double a = angle, sine = std::sin(a), cosine = std::cos(a);
  const double a2 = a * a, a3 = a2 * a;
  const Matrix6d ad2 = ad * ad;
  return Matrix6d::Identity() + (4 - a * sine - 4 * cosine) / (2 * a2) * ad +
         (4 * a - 5 * sine + a * cosine) / (2 * a3) * ad2 +
         (2 - a * sine - 2 * cosine) / (2 * a2 * a2) * ad2 * ad +
         (2 * a - 3 * sine + a * cosine) / (2 * a2 * a3) * ad2 * ad2;
}

double angleOf(const Eigen::Isometry3d& T) { return logSo3(T.linear()).norm(); }

bool isWithin(const Eigen::Isometry3d& T, double shift_m, double turn_rad) {
  return T.translation().norm() <= shift_m && angleOf(T) <= turn_rad;
}

Matrix6d independentCovariance(double sigma_m, double sigma_rad) {
  Vector6d variance;
  variance.head<3>().setConstant(sigma_m * sigma_m);
  variance.tail<3>().setConstant(sigma_rad * sigma_rad);
  return variance.asDiagonal();
}

std::optional<Eigen::Matrix3d> rotationOf(const Eigen::Quaterniond& q) {
  constexpr double kMostOff = 0.05;
  if (!(std::abs(q.norm() - 1.0) <= kMostOff)) return std::nullopt;
  return q.normalized().toRotationMatrix();
}

bool isRigid(const Eigen::Isometry3d& T) {
  constexpr double kTolerance = 1e-6;
  const Eigen::Matrix3d R = T.linear();
  return T.matrix().allFinite() && R.determinant() > 0 &&
         (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < kTolerance;
}

Eigen::Isometry3d orthonormalised(const Eigen::Isometry3d& T) {
  Eigen::Isometry3d out = T;
  out.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return out;
}

}  // namespace pf
