// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/core/frame.hpp"

namespace pf {

/// Cells of a grid that a thread takes at a time.
constexpr std::size_t kCellsAtOnce = 1024;

/// The organised point cloud on a reduced grid: one sample for each step x step block of pixels,
/// row by row. Points in the camera frame, metres.
struct SceneGrid {
  int step = 1;  ///< pixels
  int cols = 0;
  int rows = 0;
  std::vector<float> x, y, z;       ///< z = 0: the block has no depth
  std::vector<float> ray_x, ray_y;  ///< x = ray_x * z: direction through the block's centre
  cv::Mat color;                    ///< CV_8UC3, mean colour of the block, R G B
  float spacing = 0.0F;             ///< distance of neighbouring samples for z = 1, metres

  int size() const { return cols * rows; }
  bool hasDepth(int cell) const { return z[cell] > 0.0F; }
  Eigen::Vector3f point(int cell) const { return {x[cell], y[cell], z[cell]}; }
  /// Cell of a pixel, -1 outside the image.
  int cellAt(float u, float v) const;
};

/// Samples a frame. `depth_m`: its depth in metres (see depthInMetres), 0 = invalid. About
/// `grid_width` columns. Reuses the grid's memory.
void sampleGrid(const RgbdFrame& frame, const cv::Mat& depth_m, int grid_width, SceneGrid& grid);

/// Median of the depths within `radius` cells, 0 if there are none.
float medianDepth(const SceneGrid& grid, int cell, int radius);

}  // namespace pf
