// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/core/se3.hpp"
#include "posefusion/tracking/normal_equations.hpp"

namespace pf {

/// What the picture's noise adds to the information (NormalEquations::H) of the photometric term: a
/// gradient is squared there, noise and all, so that a bare wall seems to constrain the motion
/// along it. Of the same pose, gates and weights, from a part of the points, evenly spread.
Matrix6d noiseInformation(const ModelPoints& model, const FrameLevel& frame,
                          const Eigen::Isometry3d& T_frame_model, const TermSettings& settings);

}  // namespace pf
