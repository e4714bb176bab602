// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/calibration/depth_field.hpp"
#include "posefusion/core/frame.hpp"

namespace pf {

/// A field tabulated for one size of images: a look-up and a division a pixel.
class DepthCorrection {
 public:
  DepthCorrection() = default;
  DepthCorrection(const DepthField& field, const cv::Size& size);

  cv::Size size() const { return size_; }

  /// Corrects CV_16UC1 in units of `unit_m`, or CV_32FC1 in metres (`unit_m` is not used), of the
  /// table's size; `out` has the type of `depth` and must not share its memory. What is no depth
  /// (0, negative, NaN) stays none; what the field takes out of the range of the type becomes 0.
  /// Throws std::invalid_argument for another size or type.
  void apply(const cv::Mat& depth, double unit_m, cv::Mat& out) const;

 private:
  cv::Size size_;
  std::vector<float> table_;  ///< d, 1/m
};

/// Corrects the depth of frames, whatever their size; their pixels are not written to. Not thread
/// safe.
class FrameCorrector {
 public:
  explicit FrameCorrector(const DepthField& field) : field_(field) {}

  RgbdFrame correct(const RgbdFrame& frame);

 private:
  DepthField field_;
  DepthCorrection table_;
};

}  // namespace pf
