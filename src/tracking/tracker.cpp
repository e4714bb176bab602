// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/tracker.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "posefusion/tracking/normal_equations.hpp"

namespace pf {
namespace {

// A step below this (rad and m) ends a level; on the finest one it is also what "converged" means.
constexpr double kSmallStep = 5e-5;
constexpr double kConvergedStep = 2e-3;
// Least information (1 / variance, per m^2 or rad^2) in every direction: below it the system is
// singular for practical purposes (a single bare wall leaves three directions free).
constexpr double kMinInformation = 1e3;
// Residuals of so many standard deviations keep a quarter of their weight on the finest level.
constexpr float kRobustScale = 3.0F;

struct LevelResult {
  Eigen::Isometry3d T_frame_view;
  NormalEquations equations;  ///< at the last linearisation
  float brightness_offset = 0;
  double last_step = 0;
  int iterations = 0;
  bool solvable = true;
};

LevelResult alignLevel(const ModelPoints& model, const FrameLevel& frame, LevelResult start,
                       const TrackingConfig& config, TermSettings settings) {
  LevelResult result = start;
  for (int i = 0; i < config.max_iterations; ++i) {
    settings.brightness_offset = result.brightness_offset;
    result.equations = buildNormalEquations(model, frame, result.T_frame_view, settings);
    ++result.iterations;
    const NormalEquations& e = result.equations;
    const Eigen::LDLT<Matrix6d> ldlt(e.hessian());
    result.solvable = e.inliers >= 6 && ldlt.info() == Eigen::Success &&
                      ldlt.vectorD().minCoeff() > 0 && ldlt.isPositive();
    if (!result.solvable) return result;
    const Vector6d step = ldlt.solve(-e.gradient());
    if (!step.allFinite() || step.norm() > 1.0) {
      result.solvable = false;
      return result;
    }
    result.T_frame_view = expSe3(step) * result.T_frame_view;
    result.last_step = step.norm();
    if (e.photometric_weight > 0) {
      result.brightness_offset += static_cast<float>(e.photometric_sum / e.photometric_weight);
    }
    // Colours that do not fit (a misplaced colour camera, another exposure) say less: the scale of
    // the residuals is estimated, not assumed.
    if (settings.photometric_sigma > 0 && e.photometric_inliers > 0) {
      settings.photometric_sigma = static_cast<float>(std::max(
          config.photometric_sigma, std::sqrt(e.photometric_error / e.photometric_inliers)));
    }
    if (result.last_step < kSmallStep) break;
  }
  return result;
}

}  // namespace

TrackingResult track(const WorkingFrame& frame, const ModelPyramid& model,
                     const Eigen::Isometry3d& T_map_view, const Eigen::Isometry3d& T_view_camera,
                     const TrackingConfig& config) {
  TermSettings settings;
  settings.max_distance_m = static_cast<float>(config.max_distance_m);
  settings.min_normal_cosine = static_cast<float>(std::cos(config.max_normal_angle_rad));
  settings.photometric_sigma = static_cast<float>(config.photometric_sigma);

  LevelResult level;
  level.T_frame_view = T_view_camera.inverse();
  for (int i = kLevels - 1; i >= 0; --i) {
    // Coarse levels start further away: what is an outlier there may be an inlier later.
    settings.robust_scale = kRobustScale * static_cast<float>(1 << i);
    level = alignLevel(model.level(i), frame.levels[i], level, config, settings);
  }
  const NormalEquations& e = level.equations;
  TrackingResult result;
  result.T_map_camera = orthonormalised(T_map_view * level.T_frame_view.inverse());
  result.iterations = level.iterations;
  result.candidates = static_cast<int>(e.candidates);
  result.inliers = static_cast<int>(e.inliers);
  if (e.inliers > 0) result.geometric_rmse_m = std::sqrt(e.geometric_error / e.inliers);
  if (e.photometric_inliers > 0) {
    result.photometric_rmse = std::sqrt(e.photometric_error / e.photometric_inliers);
  }
  if (!level.solvable) return result;
  const Matrix6d H = e.hessian();
  const double least = Eigen::SelfAdjointEigenSolver<Matrix6d>(H).eigenvalues()[0];
  result.converged = level.last_step < kConvergedStep && least > kMinInformation;
  result.covariance = H.ldlt().solve(Matrix6d::Identity());
  return result;
}

}  // namespace pf
