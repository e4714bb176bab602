// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/core/se3.hpp"

namespace pf {

/// The numbers stand in map files.
enum class ConstraintKind {
  odometry,  ///< a step of tracking
  loop,
  reckoned  ///< where dead reckoning puts a fragment whose place is not known
};

/// A measured relative pose of two keyframes: T_from_to times a small motion, whose twist is
/// normally distributed.
struct PoseConstraint {
  int from = -1, to = -1;  ///< keyframes
  Eigen::Isometry3d T_from_to = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Identity();  ///< of the twist (m, rad) in the camera `to`
  ConstraintKind kind = ConstraintKind::loop;
};

/// How far two poses are from a measured motion between them, and how that changes with them.
struct PoseError {
  Vector6d twist;           ///< log(T_from_to^-1 * T_map_from^-1 * T_map_to): m, rad in camera `to`
  Matrix6d by_from, by_to;  ///< derivatives by twists d: T_map_x * exp(d)
};

PoseError poseError(const Eigen::Isometry3d& T_map_from, const Eigen::Isometry3d& T_map_to,
                    const Eigen::Isometry3d& T_from_to);

/// Squared Mahalanobis distance of two poses from a constraint: chi-square with 6 degrees of
/// freedom where the constraint is true.
double chiSquare(const PoseConstraint& constraint, const Eigen::Isometry3d& T_map_from,
                 const Eigen::Isometry3d& T_map_to);

}  // namespace pf
