// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posefusion/calibration/depth_field.hpp"
#include "posefusion/core/camera.hpp"
#include "simulator/sensor_config.hpp"

namespace pf::simulator {

/// Relative error of depth for each 2 m of it: smooth over the picture, fixed for a camera. About
/// one per cent at 2 m is what Teichman, Miller and Thrun ("Unsupervised Intrinsic Calibration of
/// Depth Sensors via SLAM", 2013) find before calibration.
class Distortion {
 public:
  Distortion(const DepthConfig& config, const PinholeCamera& camera);

  float at(int col, int row) const {
    const auto c = static_cast<std::size_t>(col), r = static_cast<std::size_t>(row);
    return wide_[c] * tall_[r] + narrow_[c] * low_[r];
  }

 private:
  std::vector<float> wide_, narrow_, tall_, low_;
};

/// What corrects that error, on a grid fine enough for it. A depth z is reported as
/// z (1 + z D / 2), so that 1/z is off by D / 2 to first order; here it is what is right at 2.5 m.
DepthField trueField(const DepthConfig& config, const PinholeCamera& camera);

}  // namespace pf::simulator
