// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "posefusion/core/se3.hpp"
#include "posefusion/frame/working_frame.hpp"
#include "posefusion/tracking/model_points.hpp"

namespace pf {

/// How residuals are gated and weighted.
struct TermSettings {
  float max_distance_m = 0.1F;
  float min_normal_cosine = 0.8F;
  float robust_scale = 3.0F;        ///< standard deviations at which a residual's weight is 1/4
  float photometric_sigma = 12.0F;  ///< grey levels; 0 = no photometric term
  float brightness_offset = 0.0F;   ///< added to the model's grey levels (exposure changes)
};

/// Sums over the pairs of model points and frame pixels: H = sum w J'J, g = sum w J'r for the twist
/// of T_frame_model (update exp(twist) * T_frame_model), upper triangle of H row by row.
///
/// Geometric residual: n . (q - p), q the model point moved into the frame, n its moved normal, p
/// the frame's point at the pixel that q projects to (point to plane, Chen and Medioni 1992).
/// Photometric residual: I(pixel of q) - I_model. Both have the Jacobian [a, q x a]: a = n for the
/// first, a = gradient of I through the projection for the second. Each term is weighted by
/// 1 / variance times Geman and McClure's robust weight 1 / (1 + x^2)^2 times the point's own
/// weight.
struct NormalEquations {
  double H[21] = {};
  double g[6] = {};
  double geometric_error = 0;    ///< sum of squared residuals (m^2) of the inliers
  double photometric_error = 0;  ///< sum of squared residuals of the photometric inliers
  double photometric_sum = 0;    ///< weighted sum of residuals, for the brightness offset
  double photometric_weight = 0;
  double robust_error = 0;  ///< what is minimised
  double candidates = 0;    ///< points that fall on a frame pixel with depth
  double inliers = 0;       ///< of them within the gates and 3 standard deviations
  double photometric_inliers = 0;

  Matrix6d hessian() const;
  Vector6d gradient() const;
};

/// Sums over all points of a level. The bits do not depend on the number of threads.
NormalEquations buildNormalEquations(const ModelPoints& model, const FrameLevel& frame,
                                     const Eigen::Isometry3d& T_frame_model,
                                     const TermSettings& settings);

}  // namespace pf
