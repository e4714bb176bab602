// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "simulator/depth_sensor.hpp"

namespace pf::simulator {

inline PinholeCamera xtion() { return {640, 480, 525, 525, 319.5, 239.5, {}}; }

/// What a camera before a wall sees that fills the picture.
inline DepthView wall(float z_m, float cosine = 1.0F) {
  const cv::Size size(640, 480);
  return {cv::Mat(size, CV_32FC1, cv::Scalar(z_m)),
          cv::Mat::zeros(size, CV_8UC1),
          cv::Mat(size, CV_32FC1, cv::Scalar(cosine)),
          cv::Mat(size, CV_32FC1, cv::Scalar(0.7)),
          cv::Mat::zeros(size, CV_32FC1),
          cv::Mat()};
}

inline cv::Mat sense(const DepthView& view, const DepthConfig& config, std::uint32_t key = 1U,
                     double time_s = 0.0) {
  cv::Mat depth, mask;
  const PinholeCamera camera = xtion();
  senseDepth({view, camera, config, key, time_s}, depth, mask);
  return depth;
}

/// A camera without noise and steps.
inline DepthConfig quietDepth() {
  DepthConfig config;
  config.axial = config.lateral = config.dropouts = config.distortion = 0.0;
  config.disparity_steps = 1024.0;  // as good as none
  return config;
}

}  // namespace pf::simulator
