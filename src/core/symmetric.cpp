// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/symmetric.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace pf {

Vector6d solve(const Matrix6d& A, const Vector6d& b) { return A.ldlt().solve(b); }

Matrix6d solve(const Matrix6d& A, const Matrix6d& B) { return A.ldlt().solve(B); }

SixRows solve(const Matrix6d& A, const SixRows& B) { return A.ldlt().solve(B); }

Matrix6d inverse(const Matrix6d& A) { return solve(A, Matrix6d::Identity()); }

bool isPositiveDefinite(const Matrix6d& A) {
  return A.allFinite() && A.llt().info() == Eigen::Success;
}

double mahalanobis2(const Vector6d& error, const Matrix6d& covariance) {
  return error.dot(covariance.llt().solve(error));
}

Matrix6d whitening(const Matrix6d& covariance) {
  return covariance.llt().matrixL().solve(Matrix6d::Identity());
}

SymmetricEigen eigenOf(const Eigen::Matrix3d& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace pf
