// SPDX-License-Identifier: BSD-3-Clause
#include "pose_solver.hpp"

#include <ceres/ceres.h>

#include <array>

#include "posefusion/core/symmetric.hpp"

namespace pf {
namespace {

using Increment = std::array<double, 6>;  // twist (m, rad) after the pose where solving began
using RowMajor6d = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

/// A correction shorter than this (m and rad together) is what the solver leaves undone: the pose
/// stays as it was, to the bit.
constexpr double kNothing = 1e-5;

/// Whitened error of one constraint. The poses are T * exp(increment): plain vectors, so that
/// neither of Ceres' two ways to describe SE(3), old and new, is needed.
class PoseFactor : public ceres::SizedCostFunction<6, 6, 6> {
 public:
  PoseFactor(const PoseConstraint& constraint, const Eigen::Isometry3d& T_map_from,
             const Eigen::Isometry3d& T_map_to)
      : T_map_from_(T_map_from), T_map_to_(T_map_to), T_from_to_(constraint.T_from_to) {
    whitening_ = whitening(constraint.covariance);
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Map<const Vector6d> from(parameters[0]), to(parameters[1]);
    const PoseError error =
        poseError(T_map_from_ * expSe3(from), T_map_to_ * expSe3(to), T_from_to_);
    Eigen::Map<Vector6d>{residuals} = whitening_ * error.twist;
    if (jacobians == nullptr) return true;
    // exp(x + d) = exp(x) * exp(Jr(x) * d)
    if (jacobians[0] != nullptr) {
      Eigen::Map<RowMajor6d>{jacobians[0]} = whitening_ * error.by_from * leftJacobianSe3(-from);
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<RowMajor6d>{jacobians[1]} = whitening_ * error.by_to * leftJacobianSe3(-to);
    }
    return true;
  }

 private:
  Eigen::Isometry3d T_map_from_, T_map_to_, T_from_to_;
  Matrix6d whitening_;
};

ceres::Solver::Options optionsOf(const GraphConfig& config) {
  ceres::Solver::Options options;
  options.max_num_iterations = config.max_iterations;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-8;  // beyond it poses move by hundredths of a millimetre
  options.parameter_tolerance = 1e-12;
  // Eigen's own: other libraries may add up in the order of their threads.
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.linear_solver_type = ceres::IsSparseLinearAlgebraLibraryTypeAvailable(ceres::EIGEN_SPARSE)
                                   ? ceres::SPARSE_NORMAL_CHOLESKY
                                   : ceres::DENSE_NORMAL_CHOLESKY;
  return options;
}

/// One of the ways in which errors count. `lossOf(i)`: of constraint i.
template <typename LossOf>
bool solveWith(const GraphConfig& config, const std::vector<PoseConstraint>& constraints,
               const std::vector<bool>& fixed, std::vector<Eigen::Isometry3d>& poses,
               const LossOf& lossOf) {
  std::vector<Increment> increments(poses.size(), Increment{});
  ceres::Problem problem;
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const PoseConstraint& c = constraints[i];
    const auto from = static_cast<std::size_t>(c.from), to = static_cast<std::size_t>(c.to);
    problem.AddResidualBlock(new PoseFactor(c, poses[from], poses[to]), lossOf(i),
                             increments[from].data(), increments[to].data());
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (fixed[i] && problem.HasParameterBlock(increments[i].data())) {
      problem.SetParameterBlockConstant(increments[i].data());
    }
  }
  ceres::Solver::Summary summary;
  ceres::Solve(optionsOf(config), &problem, &summary);
  if (!summary.IsSolutionUsable()) return false;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Vector6d step = Eigen::Map<const Vector6d>(increments[i].data());
    if (!step.allFinite()) return false;
    if (step.norm() > kNothing) poses[i] = orthonormalised(poses[i] * expSe3(step));
  }
  return true;
}

}  // namespace

bool solvePoses(const GraphConfig& config, const std::vector<PoseConstraint>& constraints,
                const std::vector<bool>& fixed, std::vector<Eigen::Isometry3d>& poses) {
  return solveWith(config, constraints, fixed, poses, [&](std::size_t i) -> ceres::LossFunction* {
    const bool loop = constraints[i].kind == ConstraintKind::loop;
    return loop ? new ceres::CauchyLoss(config.robust_scale) : nullptr;
  });
}

bool solvePoses(const GraphConfig& config, const std::vector<PoseConstraint>& constraints,
                const std::vector<double>& weights, const std::vector<bool>& fixed,
                std::vector<Eigen::Isometry3d>& poses) {
  return solveWith(config, constraints, fixed, poses, [&](std::size_t i) -> ceres::LossFunction* {
    return new ceres::ScaledLoss(nullptr, weights[i], ceres::TAKE_OWNERSHIP);
  });
}

}  // namespace pf
