// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pf {

/// Standard deviation (m) of a structured-light depth measurement at distance z (m), along the
/// axis: Nguyen, Izadi, Lovell, "Modeling Kinect Sensor Noise for Improved 3D Reconstruction and
/// Tracking", 3DIMPVT 2012, equation (3) without its angular term.
constexpr float depthSigma(float z_m) { return 0.0012F + 0.0019F * (z_m - 0.4F) * (z_m - 0.4F); }

/// Depths that differ by less (m) may lie on one surface: `sigmas` standard deviations of the
/// noise, and a centimetre for its slope.
constexpr float surfaceTolerance(float z_m, float sigmas) {
  return 0.01F + sigmas * depthSigma(z_m);
}

}  // namespace pf
