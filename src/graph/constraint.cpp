// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/graph/constraint.hpp"

#include <Eigen/LU>

#include "posefusion/core/symmetric.hpp"

namespace pf {

PoseError poseError(const Eigen::Isometry3d& T_map_from, const Eigen::Isometry3d& T_map_to,
                    const Eigen::Isometry3d& T_from_to) {
  const Eigen::Isometry3d T_to_from = T_map_to.inverse() * T_map_from;
  PoseError error;
  error.twist = logSe3(T_from_to.inverse() * T_to_from.inverse());
  // log(exp(e) * exp(d)) = e + Jr(e)^-1 * d, and a step of `from` is the opposite step of `to`.
  error.by_to = leftJacobianSe3(-error.twist).inverse();
  error.by_from = -error.by_to * adjoint(T_to_from);
  return error;
}

double chiSquare(const PoseConstraint& constraint, const Eigen::Isometry3d& T_map_from,
                 const Eigen::Isometry3d& T_map_to) {
  const Vector6d twist = logSe3(constraint.T_from_to.inverse() * T_map_from.inverse() * T_map_to);
  return mahalanobis2(twist, constraint.covariance);
}

}  // namespace pf
