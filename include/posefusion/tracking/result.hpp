// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/core/se3.hpp"
#include "posefusion/tracking/normal_equations.hpp"

namespace pf {

/// Outcome of aligning one frame with the model.
struct TrackingResult {
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  bool converged = false;   ///< the last step was small and the system could be solved
  int iterations = 0;       ///< over all levels
  int candidates = 0;       ///< model points of the finest level that fall on depth of the frame
  int inliers = 0;          ///< of them matched in the last iteration
  int seen_through = 0;     ///< of them well before the surface that the frame sees
  int free_directions = 0;  ///< of six, those the images hardly fix: there the prior decides
  double geometric_rmse_m = 0;             ///< point-to-plane, over the inliers
  double photometric_rmse = 0;             ///< grey levels, over the inliers
  double cost = 0;                         ///< mean robust cost of the candidates, 0 to 1
  Brightness brightness;                   ///< of the frame against the model
  Matrix6d covariance = Matrix6d::Zero();  ///< of the twist (m, rad) in the camera frame
  /// The same of what the sensor's errors that do not average out add to it; where it was asked
  /// for.
  Matrix6d systematic = Matrix6d::Zero();
  double distance_m = 0;    ///< of what was aligned, mean; where it was asked for
  double prior_weight = 1;  ///< left to the prior, (0, 1]: the images may contradict it
};

}  // namespace pf
