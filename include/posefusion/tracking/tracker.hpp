// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/frame/model_view.hpp"
#include "posefusion/frame/working_frame.hpp"
#include "posefusion/tracking/config.hpp"
#include "posefusion/tracking/model_points.hpp"
#include "posefusion/tracking/result.hpp"

namespace pf {

/// What is known of a frame's pose before it is aligned.
struct PosePrior {
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Identity();  ///< of the twist (m, rad) in the camera frame
  bool is_measured = false;                    ///< from corners; else extrapolated
};

/// Where an alignment begins.
struct TrackingStart {
  Eigen::Isometry3d T_map_view = Eigen::Isometry3d::Identity();    ///< the model's camera
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();  ///< first guess
  PosePrior prior;               ///< a weak factor, which decides where the images say little
  Brightness brightness;         ///< first guess
  bool prior_is_firm = false;    ///< else the prior gives way where the images contradict it
  bool with_systematic = false;  ///< TrackingResult::systematic and distance_m are wanted
};

/// Aligns a frame with the model seen in a view: Gauss-Newton from the coarsest level to the
/// finest, geometric and photometric residuals and the prior in one system with consistent weights.
/// A step that does not lower the cost is halved, then given up. Keeps no state; the result says
/// how far it can be trusted, the caller decides.
///
/// The covariance counts neighbouring pixels, whose errors go together, as one measurement, and
/// directions that only the noise of the normals seems to fix (a bare wall's own plane) as free: in
/// those the prior decides.
TrackingResult track(const WorkingFrame& frame, const ModelPyramid& model,
                     const TrackingStart& start, const TrackingConfig& config);

}  // namespace pf
