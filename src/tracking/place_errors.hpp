// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/core/se3.hpp"
#include "posefusion/tracking/normal_equations.hpp"

namespace pf {

/// What the sensor's errors that do not average out do to the sums of an alignment. They are the
/// same within a place of the image, and do not depend on each other from place to place.
struct PlaceErrors {
  Matrix6d gradient = Matrix6d::Zero();  ///< covariance that they give to NormalEquations::g
  double distance_m = 0;  ///< of the pairs; the harmonic mean, as a shift moves pictures by 1 / it
};

/// Of the geometric term at the same pose, and with the same gates and weights, as
/// buildNormalEquations(). From a part of the points, evenly spread.
PlaceErrors placeErrors(const ModelPoints& model, const FrameLevel& frame,
                        const Eigen::Isometry3d& T_frame_model, const TermSettings& settings);

}  // namespace pf
