// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "simulator/color_config.hpp"

namespace pf::simulator {

/// How long and how strongly the colour camera looks.
struct Exposure {
  double time_ms = 16.0;
  double gain = 1.0;
};

/// Chooses the exposure from the brightness of the pictures so far, in steps as cameras do.
class AutoExposure {
 public:
  explicit AutoExposure(const ColorConfig& config) : config_(config) {}

  Exposure current() const;
  /// Looks at a picture's radiance. The first one sets the exposure at once.
  void look(const cv::Mat& radiance);
  /// Whether a picture has set it, or none needs to.
  bool isSet() const { return product_ms_ > 0.0 || !config_.auto_exposure; }
  void restart() { product_ms_ = 0.0; }

 private:
  ColorConfig config_;
  double product_ms_ = 0.0;  ///< time x gain
  int wait_ = 0;
};

/// From radiance (CV_32FC3) to the picture (CV_8UC3, R G B): lens, vignette, photon and read noise,
/// white balance, tone curve, JPEG. `key` makes the noise of this frame.
class ColorSensor {
 public:
  explicit ColorSensor(const ColorConfig& config);
  void expose(const cv::Mat& radiance, const Exposure& exposure, std::uint32_t key,
              cv::Mat& picture);

 private:
  ColorConfig config_;
  cv::Mat soft_;
  std::vector<std::uint8_t> tone_;
};

}  // namespace pf::simulator
