// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulator/depth_config.hpp"

namespace pf::simulator {

/// Standard deviation along the view (m) at depth `z_m` and angle `theta_rad` between view and
/// surface normal: Nguyen, Izadi, Lovell, "Modeling Kinect Sensor Noise for Improved 3D
/// Reconstruction and Tracking", 2012, equations 3 and 4.
double axialSigmaM(double z_m, double theta_rad);

/// The same seen head on: equation 3 without its angular term.
constexpr float headOnSigma(float z_m) { return 0.0012F + 0.0019F * (z_m - 0.4F) * (z_m - 0.4F); }

/// Standard deviation across the view (pixels), ibid. equation 2.
double lateralSigmaPx(double theta_rad);

/// Width of one step of depth (m): disparity in steps of 1 / steps pixels (Khoshelham and Elberink,
/// "Accuracy and Resolution of Kinect Depth Data", 2012, section 2.4).
double quantumM(double z_m, const DepthConfig& config, double focal_px);

/// What the noise needs to know of an angle between view and surface.
struct Slant {
  float theta_rad, lateral_px, tilt;
};

/// The slant of a surface by the cosine of its angle, from a table: there is one for each pixel.
const Slant& slantOf(float cosine);

}  // namespace pf::simulator
