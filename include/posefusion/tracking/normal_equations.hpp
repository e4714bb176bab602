// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "posefusion/core/depth_sensor.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/frame/working_frame.hpp"
#include "posefusion/tracking/model_points.hpp"

namespace pf {

/// Grey level of the frame = gain * grey level of the model + offset (exposure changes).
struct Brightness {
  float gain = 1.0F;
  float offset = 0.0F;
};

/// How residuals are gated and weighted.
struct TermSettings {
  float max_distance_m = 0.1F;
  float min_normal_cosine = 0.8F;
  float robust_scale = 3.0F;        ///< standard deviations at which a residual's weight is 1/4
  float photometric_sigma = 12.0F;  ///< grey levels; 0 = no photometric term
  Brightness brightness;            ///< of the frame against the model
  DepthSensor sensor;               ///< of the frame
};

/// Sums over the pairs of model points and frame pixels: H = sum w J'J, g = sum w J'r for the twist
/// of T_frame_model (update exp(twist) * T_frame_model), upper triangle of H row by row.
///
/// Geometric residual: n . (q - p), q the model point moved into the frame, n its moved normal, p
/// the frame's point at the pixel that q projects to (point to plane, Chen and Medioni 1992).
/// Photometric residual: I(pixel of q) - (gain * I_model + offset). Both have the Jacobian [a, q x
/// a]: a = n for the first, a = gradient of I through the projection for the second. Each term is
/// weighted by 1 / variance times Geman and McClure's robust weight 1 / (1 + x^2)^2 times the
/// point's own weight.
struct NormalEquations {
  double H[21] = {};
  double g[6] = {};
  double geometric_error = 0;    ///< sum of squared residuals (m^2) of the inliers
  double photometric_error = 0;  ///< sum of squared residuals of the photometric inliers
  double brightness[5] = {};     ///< weighted sums 1, m, y, m m, m y of model (m) and frame (y)
  double cost = 0;               ///< mean robust cost of the candidates, 0 to 1: what is minimised
  double cost_weight = 0;        ///< sum of the weights that the mean is taken over
  double candidates = 0;         ///< points that fall on a frame pixel with depth
  double inliers = 0;            ///< of them within the gates and 3 standard deviations
  double photometric_inliers = 0;
  double seen_through = 0;  ///< candidates well behind which the frame sees another surface

  Matrix6d hessian() const;
  Vector6d gradient() const;
  /// Gain and offset that fit the grey levels best, held near gain 1 where there is little
  /// contrast.
  Brightness fittedBrightness() const;
};

/// Sums over all points of a level. The bits do not depend on the number of threads.
NormalEquations buildNormalEquations(const ModelPoints& model, const FrameLevel& frame,
                                     const Eigen::Isometry3d& T_frame_model,
                                     const TermSettings& settings);

}  // namespace pf
