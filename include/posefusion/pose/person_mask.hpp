// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "posefusion/pose/depth_input.hpp"
#include "posefusion/pose/skeleton.hpp"

namespace pf {

constexpr int kMaskWidth = kDepthInputWidth / 2, kMaskHeight = kDepthInputHeight / 2;

/// Where the cells of a PersonMask lie in an image.
class MaskGrid {
 public:
  explicit MaskGrid(const cv::Size& image) : grid_(depthInputGrid(image)) {}

  /// Column and row (cell centres at integers) of a place of the image (pixels).
  cv::Point2f toCell(float u, float v) const {
    const double size_px = 2.0 * grid_.step_px;
    return {static_cast<float>((u + 0.5 - grid_.left_px) / size_px - 0.5),
            static_cast<float>((v + 0.5 - grid_.top_px) / size_px - 0.5)};
  }

  /// Index of the cell, row by row, that holds a place of the image (pixels); -1: none does.
  int cellAt(float u, float v) const {
    const cv::Point2f at = toCell(u, v);
    const float x = std::floor(at.x + 0.5F), y = std::floor(at.y + 0.5F);
    if (!(x >= 0.0F && y >= 0.0F && x < kMaskWidth && y < kMaskHeight)) return -1;
    return static_cast<int>(y) * kMaskWidth + static_cast<int>(x);
  }

 private:
  DepthInputGrid grid_;
};

}  // namespace pf
