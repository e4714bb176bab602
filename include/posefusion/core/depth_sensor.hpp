// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pf {

/// How a depth camera measures.
enum class DepthSensorKind { structured_light, time_of_flight, active_stereo };

/// What is known of a depth camera: its range and its errors, as docs/sensor.md derives them. The
/// default is a Kinect 1 or Xtion; depthSensorOf() makes that of the settings. A plain value: inner
/// loops take a copy.
struct DepthSensor {
  DepthSensorKind kind = DepthSensorKind::structured_light;

  /// Standard deviation of a measurement at distance z (m) along the axis:
  /// axial_m + axial_1_m (z - axial_from_m)^2.
  float axial_m = 0.0012F, axial_1_m = 0.0019F, axial_from_m = 0.4F;

  /// Across the axis: by so much (rad) a measurement may belong to another ray.
  double lateral_rad = 0.0015;

  /// Depth comes in steps of so much inverse depth (1/m); 0: finer than its noise.
  float step_1_m = 0.0029F;

  /// What does not average out, in one place of the image against another: in depth (m), and in
  /// inverse depth (1/m).
  float systematic_m = 0.0F, systematic_1_m = 0.0026F;

  /// Depth that is used; frame.min_depth_m and frame.max_depth_m.
  double min_depth_m = 0.3, max_depth_m = 8.0;

  /// Standard deviation (m) of a measurement of z (m).
  constexpr float sigma(float z_m) const {
    return axial_m + axial_1_m * (z_m - axial_from_m) * (z_m - axial_from_m);
  }

  /// Depths that differ by less (m) may lie on one surface: `sigmas` standard deviations of the
  /// noise or what two places of the image differ by, whichever is more, and a centimetre for the
  /// surface's slope.
  constexpr float tolerance(float z_m, float sigmas) const {
    const float by_noise = kSlope_m + sigmas * sigma(z_m);
    const float by_place = kSlope_m + placeError(z_m);
    return by_noise < by_place ? by_place : by_noise;
  }

 private:
  static constexpr float kSlope_m = 0.01F;
  static constexpr float kTwoPlaces = 1.414F;  // two errors that do not depend on each other

  constexpr float placeError(float z_m) const {
    const float systematic = kTwoPlaces * systematic_1_m;
    const float per_square = systematic < step_1_m ? step_1_m : systematic;
    return kTwoPlaces * systematic_m + per_square * z_m * z_m;
  }
};

}  // namespace pf
