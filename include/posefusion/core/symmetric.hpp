// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "posefusion/core/se3.hpp"

namespace pf {

// Symmetric matrices of the size of a motion or of a point. Eigen's factorisations take seconds to
// compile: they are compiled here once.

/// Any number of columns of the size of a motion.
using SixRows = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// A^-1 * b and A^-1 * B of a positive semidefinite matrix. @{
Vector6d solve(const Matrix6d& A, const Vector6d& b);
Matrix6d solve(const Matrix6d& A, const Matrix6d& B);
SixRows solve(const Matrix6d& A, const SixRows& B);
template <typename Expression>
auto solve(const Matrix6d& A, const Eigen::MatrixBase<Expression>& B) {
  return solve(A, B.eval());
}
/// @}

/// A^-1 of a positive semidefinite matrix.
Matrix6d inverse(const Matrix6d& A);

bool isPositiveDefinite(const Matrix6d& A);

/// Squared Mahalanobis distance: error^T * covariance^-1 * error, of a positive definite
/// covariance.
double mahalanobis2(const Vector6d& error, const Matrix6d& covariance);

/// W with W * covariance * W^T = 1: errors times it are independent, of deviation 1.
Matrix6d whitening(const Matrix6d& covariance);

/// The covariance of A * x, with x of `covariance`.
inline Matrix6d propagated(const Matrix6d& A, const Matrix6d& covariance) {
  return A * covariance * A.transpose();
}

/// Eigenvalues, ascending, and their vectors, of unit length, as columns.
struct SymmetricEigen {
  Eigen::Vector3d values;
  Eigen::Matrix3d vectors;
};
SymmetricEigen eigenOf(const Eigen::Matrix3d& A);

}  // namespace pf
