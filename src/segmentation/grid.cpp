// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr float kFarOutside_px = 1e6F;   // still a whole number
constexpr std::size_t kMaxDepths = 128;  // of a median

/// The depth of a block: the valid pixel nearest to its centre. A mean would mix person and wall.
float blockDepth(const cv::Mat& depth_m, int row, int col, int step) {
  const int centre = step / 2;
  for (int reach = 0; reach <= centre; ++reach) {
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        if (std::max(std::abs(dx), std::abs(dy)) != reach) continue;
        const int y = row * step + centre + dy;
        const int x = col * step + centre + dx;
        if (x >= (col + 1) * step || y >= (row + 1) * step) continue;
        if (y >= depth_m.rows || x >= depth_m.cols) continue;
        const float z = depth_m.at<float>(y, x);
        if (z > 0.0F) return z;
      }
    }
  }
  return 0.0F;
}

}  // namespace

int SceneGrid::cellAt(float u, float v) const {
  if (!(u > -0.5F && v > -0.5F)) return -1;
  const int col = static_cast<int>(std::lround(std::min(u, kFarOutside_px))) / step;
  const int row = static_cast<int>(std::lround(std::min(v, kFarOutside_px))) / step;
  return col < cols && row < rows ? row * cols + col : -1;
}

void sampleGrid(const RgbdFrame& frame, const cv::Mat& depth_m, int grid_width, SceneGrid& grid) {
  const int width = depth_m.cols;
  const int height = depth_m.rows;
  grid.step = std::max(1, static_cast<int>(std::lround(static_cast<double>(width) / grid_width)));
  grid.cols = (width + grid.step - 1) / grid.step;
  grid.rows = (height + grid.step - 1) / grid.step;
  for (auto* field : {&grid.x, &grid.y, &grid.z, &grid.ray_x, &grid.ray_y}) {
    field->resize(grid.size());
  }
  const PinholeCamera& camera = frame.camera;
  grid.spacing = static_cast<float>(grid.step / camera.fx);
  cv::resize(frame.color, grid.color, cv::Size(grid.cols, grid.rows), 0, 0, cv::INTER_AREA);
  parallelFor(grid.rows, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      for (int col = 0; col < grid.cols; ++col) {
        const int cell = row * grid.cols + col;
        const double u = col * grid.step + 0.5 * (grid.step - 1);
        const double v = row * grid.step + 0.5 * (grid.step - 1);
        grid.ray_x[cell] = static_cast<float>((u - camera.cx) / camera.fx);
        grid.ray_y[cell] = static_cast<float>((v - camera.cy) / camera.fy);
        grid.z[cell] = blockDepth(depth_m, row, col, grid.step);
        grid.x[cell] = grid.ray_x[cell] * grid.z[cell];
        grid.y[cell] = grid.ray_y[cell] * grid.z[cell];
      }
    }
  });
}

float medianDepth(const SceneGrid& grid, int cell, int radius) {
  std::array<float, kMaxDepths> depths;
  std::size_t count = 0;
  const int row = cell / grid.cols;
  const int col = cell % grid.cols;
  for (int r = std::max(0, row - radius); r <= std::min(grid.rows - 1, row + radius); ++r) {
    for (int c = std::max(0, col - radius); c <= std::min(grid.cols - 1, col + radius); ++c) {
      const float z = grid.z[r * grid.cols + c];
      if (z > 0.0F && count < depths.size()) depths[count++] = z;
    }
  }
  if (count == 0) return 0.0F;
  std::nth_element(depths.begin(), depths.begin() + count / 2, depths.begin() + count);
  return depths[count / 2];
}

}  // namespace pf
