// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/frame/model_view.hpp"
#include "posefusion/frame/working_frame.hpp"
#include "posefusion/tracking/config.hpp"
#include "posefusion/tracking/model_points.hpp"
#include "posefusion/tracking/result.hpp"

namespace pf {

/// Aligns a frame with the model seen in a view: Gauss-Newton from the coarsest level to the
/// finest, geometric and photometric residuals in one system with consistent weights.
/// `T_view_camera` is the first guess of the frame's pose in the view's camera frame. `model`
/// belongs to `view`. Keeps no state; the result says how far it can be trusted, the caller
/// decides.
TrackingResult track(const WorkingFrame& frame, const ModelPyramid& model,
                     const Eigen::Isometry3d& T_map_view, const Eigen::Isometry3d& T_view_camera,
                     const TrackingConfig& config);

}  // namespace pf
