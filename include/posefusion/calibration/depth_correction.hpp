// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/calibration/depth_field.hpp"

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

  /// The same with `out` in metres, CV_32FC1, whatever the type of `depth`: nothing is rounded.
  void applyInMetres(const cv::Mat& depth, double unit_m, cv::Mat& out) const;

 private:
  void require(const cv::Mat& depth) const;
  const float* row(int v) const { return &table_[static_cast<std::size_t>(v * size_.width)]; }

  cv::Size size_;
  std::vector<float> table_;  ///< d, 1/m
};

/// Corrects depth images, whatever their size; their pixels are not written to. Not thread safe.
class DepthCorrector {
 public:
  explicit DepthCorrector(const DepthField& field) : field_(field) {}

  /// The same with its table made, so that the first image of that size does not wait for it.
  DepthCorrector(const DepthField& field, const cv::Size& size)
      : field_(field), table_(field, size) {}

  /// In metres, CV_32FC1, in memory of its own; empty and other types than DepthCorrection takes
  /// come back as they are.
  cv::Mat inMetres(const cv::Mat& depth, double unit_m);
  /// In units and type of `depth`.
  cv::Mat likeInput(const cv::Mat& depth, double unit_m);

 private:
  const DepthCorrection* tableFor(const cv::Mat& depth);

  DepthField field_;
  DepthCorrection table_;
};

}  // namespace pf
