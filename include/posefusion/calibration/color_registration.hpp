// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "posefusion/calibration/color_camera.hpp"
#include "posefusion/core/frame.hpp"

namespace pf {

/// Gives each pixel of depth its colour. Pixels without depth take that of what is farther of their
/// neighbours in the row. What is hidden from the colour camera by something nearer takes the
/// colour beside it; what is outside of its image, that of the border. Not thread safe.
class ColorRegistration {
 public:
  explicit ColorRegistration(const ColorCamera& camera) : camera_(camera) {}

  /// The frame with colour as the depth camera would see it, in memory of its own.
  RgbdFrame registered(const RgbdFrame& frame);

 private:
  ColorCamera camera_;
  cv::Mat depth_m_, x_, y_;  ///< CV_32FC1; where in the colour image
};

}  // namespace pf
