// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

namespace pf {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kDegreesPerRadian = 180.0 / M_PI;

/// Skew-symmetric matrix: hat(a) * b = a x b.
Eigen::Matrix3d hat(const Eigen::Vector3d& omega);

/// Rotation of an axis-angle vector (rad), Rodrigues' formula.
Eigen::Matrix3d expSo3(const Eigen::Vector3d& omega);

/// Axis-angle vector (rad, length <= pi) of a rotation.
Eigen::Vector3d logSo3(const Eigen::Matrix3d& rotation);

/// Rigid motion of a twist (translation part v in metres first, rotation part omega in rad last).
Eigen::Isometry3d expSe3(const Vector6d& twist);

/// Twist of a rigid motion; inverse of expSe3 for rotations below pi.
Vector6d logSe3(const Eigen::Isometry3d& T);

/// Takes twists of one frame to another: exp(adjoint(T) * twist) = T * exp(twist) * T^-1.
Matrix6d adjoint(const Eigen::Isometry3d& T);

/// Left Jacobian of the exponential: exp(twist + d) = exp(leftJacobianSe3(twist) * d) * exp(twist)
/// for small d. The right one is that of -twist. Barfoot, "State Estimation for Robotics", 2017,
/// equation (7.83) ff.
Matrix6d leftJacobianSe3(const Vector6d& twist);

/// Angle (rad, at most pi) that a rigid motion turns by.
double angleOf(const Eigen::Isometry3d& T);

/// Does a motion shift by at most `shift_m` and turn by at most `turn_rad`?
bool isWithin(const Eigen::Isometry3d& T, double shift_m, double turn_rad);

/// Covariance of a twist whose parts are independent, each with these standard deviations.
Matrix6d independentCovariance(double sigma_m, double sigma_rad);

/// Whether all of it is finite and its rotation is one, as far as rounding goes.
bool isRigid(const Eigen::Isometry3d& T);

/// The rotation of a quaternion. Nothing where it is not of unit length, to 5 %, or not finite.
std::optional<Eigen::Matrix3d> rotationOf(const Eigen::Quaterniond& q);

/// The nearest rigid motion: the rotation re-orthonormalised (many products lose it slowly).
Eigen::Isometry3d orthonormalised(const Eigen::Isometry3d& T);

}  // namespace pf
