// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "posefusion/core/depth_sensor.hpp"
#include "posefusion/core/frame.hpp"
#include "posefusion/core/pace.hpp"
#include "posefusion/frame/config.hpp"

namespace pf {

constexpr int kLevels = 3;

/// One level of the image pyramid of a frame. All planes have the camera's size.
struct FrameLevel {
  PinholeCamera camera;
  cv::Mat depth_m;                       ///< CV_32FC1, smoothed, 0 = invalid
  cv::Mat normal_x, normal_y, normal_z;  ///< CV_32FC1, towards the camera; 0 = invalid
  cv::Mat intensity;                     ///< CV_32FC1, 0..255
  cv::Mat still;                         ///< CV_8UC1, 255 where the colour is no person's
};

/// A frame as tracking and fusion see it: shrunk, smoothed, with normals, as a pyramid.
struct WorkingFrame {
  PinholeCamera camera;
  DepthSensor sensor;                      ///< that took it, in the range that is used
  cv::Mat depth_m;                         ///< CV_32FC1, shrunk but not smoothed: what is fused
  cv::Mat beyond_m;                        ///< CV_32FC1, depth past max_depth_m, 0 = none
  cv::Mat color;                           ///< CV_8UC3 R G B
  std::array<FrameLevel, kLevels> levels;  ///< finest first; level 0 has the camera above
  int valid_pixels = 0;                    ///< of depth_m
  PinholeCamera full_camera;
  cv::Mat full_depth_m;  ///< CV_32FC1, full size, 0 = invalid
  cv::Mat full_color;    ///< CV_8UC3 R G B, full size: the frame's own, valid as long as that is
  Pace pace;             ///< of the frames; assign() leaves it

  /// Prepares everything from a frame; `mask` (255 = person) may be empty. The range is that of
  /// `config`. Reuses memory.
  void assign(const RgbdFrame& frame, const cv::Mat& mask, const FrameConfig& config,
              const DepthSensor& taken_by = {});

  /// A copy that shares no memory with this one, without full_color.
  WorkingFrame clone() const;

 private:
  cv::Mat smooth_m_;
};

}  // namespace pf
