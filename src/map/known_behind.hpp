// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "lower_to.hpp"

namespace pf {

/// Where what a frame sees stands well before a surface that the map knows: something that came, or
/// that was hidden until now. Kept for cells of some pixels: surfels may be sparser than pixels,
/// and the map has holes.
class KnownBehind {
 public:
  /// Nothing is known yet of an image of this size.
  void assign(const cv::Size& size) {
    cols_ = (size.width + kCell_px - 1) / kCell_px;
    rows_ = (size.height + kCell_px - 1) / kCell_px;
    cells_.assign(static_cast<std::size_t>(cols_) * static_cast<std::size_t>(rows_), kNothing);
  }

  /// The frame sees `depth_m` in pixel (u, v), and the map knows a surface behind. Threads may call
  /// it at once: the nearest of a cell stays.
  void mark(int u, int v, float depth_m) {
    const float mm = std::min(1e3F * depth_m, static_cast<float>(kNothing - 1));
    lowerTo(&cells_[at(u / kCell_px, v / kCell_px)], static_cast<std::uint16_t>(mm));
  }

  /// Whether a surface is known behind `depth_m` in pixel (u, v), or behind what is seen around it
  /// at the same depth, within `tolerance_m`: the parts of a thing came together.
  bool has(int u, int v, float depth_m, float tolerance_m) const {
    const int column = u / kCell_px, row = v / kCell_px;
    for (int y = std::max(0, row - kAround); y <= std::min(rows_ - 1, row + kAround); ++y) {
      for (int x = std::max(0, column - kAround); x <= std::min(cols_ - 1, column + kAround); ++x) {
        const std::uint16_t mm = cells_[at(x, y)];
        if (mm != kNothing && std::abs(1e-3F * static_cast<float>(mm) - depth_m) <= tolerance_m) {
          return true;
        }
      }
    }
    return false;
  }

 private:
  static constexpr int kCell_px = 4;
  static constexpr int kAround = 2;  // cells: holes of the map up to 16 pixels wide
  static constexpr std::uint16_t kNothing = 65535;

  std::size_t at(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols_) +
           static_cast<std::size_t>(column);
  }

  std::vector<std::uint16_t> cells_;
  int cols_ = 0, rows_ = 0;
};

}  // namespace pf
