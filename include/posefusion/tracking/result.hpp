// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/core/se3.hpp"

namespace pf {

/// Outcome of aligning one frame with the model.
struct TrackingResult {
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  bool converged = false;       ///< the last step was small and the system well conditioned
  int iterations = 0;           ///< over all levels
  int candidates = 0;           ///< pixels of the finest level with depth in frame and model
  int inliers = 0;              ///< of them matched in the last iteration
  double geometric_rmse_m = 0;  ///< point-to-plane, over the inliers
  double photometric_rmse = 0;  ///< grey levels, over the inliers
  Matrix6d covariance = Matrix6d::Zero();  ///< of the twist (m, rad) in the camera frame
};

}  // namespace pf
