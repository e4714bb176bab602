// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posefusion/calibration/depth_field.hpp"
#include "posefusion/core/camera.hpp"
#include "simulator/depth_config.hpp"

namespace pf::simulator {

/// The systematic errors of a depth camera at one time: fixed over the picture, each specimen its
/// own.
///
/// - Smooth waves, about one per cent at 2 m, growing with z^2: what Teichman, Miller and Thrun
///   ("Unsupervised Intrinsic Calibration of Depth Sensors via SLAM", 2013) find before
///   calibration.
/// - Vertical bands with steps between them, as the pictures of a Kinect's residuals have them
///   (Smisek, Jancosek and Pajdla, "3D with Kinect", 2011); an offset of disparity, so with z^2.
/// - A bowl, growing with the square of the radius and with z or z^2: the shape that Di Cicco,
///   Iocchi and Grisetti ("Non-parametric calibration for depth sensors", 2015) calibrate, and the
///   distance-dependent distortion of Herrera, Kannala and Heikkila ("Joint depth and color camera
///   calibration with distortion correction", 2012).
/// - Warming up (Fiedler and Mueller, "Impact of Thermal and Environmental Conditions on the Kinect
///   Sensor", 2013: millimetres a kelvin): an error all over, and larger waves, that fade.
class Distortion {
 public:
  /// `time_s`: since the camera was switched on.
  Distortion(const DepthConfig& config, const PinholeCamera& camera, double time_s);

  /// The depth (m) that is reported for z_m, but for noise.
  float bent(int col, int row, float z_m) const {
    return z_m * (1.0F + 0.5F * z_m * waves(col, row)) + others(col, row, z_m);
  }

  /// What is added to z_m, divided by z_m^2; without the bands.
  float smooth(int col, int row, float z_m) const {
    return 0.5F * waves(col, row) + bowl(col, row, z_m) + cold_;
  }

 private:
  /// Relative error for each 2 m of depth.
  float waves(int col, int row) const {
    const auto c = static_cast<std::size_t>(col), r = static_cast<std::size_t>(row);
    return wide_[c] * tall_[r] + narrow_[c] * low_[r];
  }
  float bowl(int col, int row, float z_m) const {
    const auto c = static_cast<std::size_t>(col), r = static_cast<std::size_t>(row);
    return (aside_[c] + above_[r]) * (linear_bowl_ ? 2.0F / z_m : 1.0F);
  }
  float others(int col, int row, float z_m) const {
    if (!has_others_) return 0.0F;
    const float share = bowl(col, row, z_m) + cold_ + stripes_[static_cast<std::size_t>(col)];
    return z_m * z_m * share;
  }

  std::vector<float> wide_, narrow_, tall_, low_;  ///< of the waves
  std::vector<float> stripes_, aside_, above_;     ///< 1/m
  float cold_ = 0.0F;                              ///< 1/m
  bool linear_bowl_ = false;
  bool has_others_ = false;
};

/// What corrects the smooth errors at that time, on a grid fine enough for them. A depth z is
/// reported as z + z^2 h, so that 1/z is off by h to first order; here it is what is right at 2.5
/// m, also for a bowl that grows with z alone. Steps between bands are no smooth field: left out.
DepthField trueField(const DepthConfig& config, const PinholeCamera& camera, double time_s);

}  // namespace pf::simulator
