// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace pf {

/// Size of the embedded person model's input, pixels.
constexpr int kDepthInputWidth = 160;
constexpr int kDepthInputHeight = 120;
/// Depth outside (nearest, farthest), metres, is not shown to the model.
constexpr float kDepthInputNearest_m = 0.25F;
constexpr float kDepthInputFarthest_m = 8.0F;

/// Where the model's input lies in a depth image: square cells, the image in the middle and all of
/// it inside, so that 640x480 becomes cells of exactly 4x4 pixels and other shapes get empty
/// borders.
struct DepthInputGrid {
  double step_px = 4.0;  ///< width of a cell in pixels of the image
  double left_px = 0.0;  ///< left border of the first cell, from the image's left border
  double top_px = 0.0;

  /// Pixel of the image (centres at integers) of a place of the model's input (the same).
  cv::Point2f toImage(const cv::Point2f& cell) const;
};

DepthInputGrid depthInputGrid(const cv::Size& image);

/// Shrinks depth (CV_32FC1, metres, any size) to the model's 160x120, CV_32FC1, metres: in each
/// cell the lower median of the pixels within the model's range, 0 where fewer than two are (NaN
/// and infinite ones are not; of cells of up to two pixels one is enough). A median keeps the edge
/// of a body sharp where a mean would invent points between it and the wall.
void shrinkDepth(const cv::Mat& depth_m, cv::Mat& small_m);

/// The model's input of a shrunk depth, CV_32F 1x3x120x160: 1 / depth (1/m), ln(depth / m),
/// and 1 where there is depth; all 0 where there is none.
void depthInput(const cv::Mat& small_m, cv::Mat& blob);

}  // namespace pf
