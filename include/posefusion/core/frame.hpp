// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

#include "posefusion/core/camera.hpp"

namespace pf {

/// One registered colour and depth pair. Immutable once made: stages share the pixels.
struct RgbdFrame {
  std::int64_t stamp_ns = 0;   ///< time of the colour image, nanoseconds
  cv::Mat color;               ///< CV_8UC3, R G B
  cv::Mat depth;               ///< CV_16UC1 in units of depth_unit_m, or CV_32FC1 in metres
  double depth_unit_m = 1e-3;  ///< metres for one step of a CV_16UC1 depth
  PinholeCamera camera;        ///< of both images
};

/// Why the frame cannot be used (sizes or encodings that disagree with each other or with the
/// camera), naming what was found and what was expected; empty when it can.
std::string defectOf(const RgbdFrame& frame);

/// Depth along the optical axis as CV_32FC1 in metres; invalid pixels (0, NaN, infinite, outside
/// [min_depth_m, max_depth_m]) are 0. Writes into `depth_m`, reusing its memory.
void depthInMetres(const RgbdFrame& frame, double min_depth_m, double max_depth_m,
                   cv::Mat& depth_m);

/// The frame without lens distortion: colour by linear, depth by nearest interpolation. The maps
/// are made once per camera. A frame of an undistorted camera passes through untouched (same
/// pixels).
class Rectifier {
 public:
  RgbdFrame rectify(const RgbdFrame& frame);

 private:
  PinholeCamera camera_;
  cv::Mat map1_, map2_;
};

}  // namespace pf
