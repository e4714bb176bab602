// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "point_cubes.hpp"

namespace pf {

/// How azimuth and elevation (rad) are cut into bins. Column `heading * phases + phase`: the bins
/// of one phase lie one heading apart.
struct PanoramaShape {
  int headings = 48;
  int phases = 4;
  int rows = 0;          ///< of elevation
  float lowest_rad = 0;  ///< elevation of the lower edge of row 0
  float max_range_m = 6;

  int columns() const { return headings * phases; }
  float bin_rad() const;
};

/// Points around a position, as their nearest ranges by direction. Stored as [row][phase][heading],
/// the headings twice over, so that all headings of a pixel of a camera are one run of memory.
class Panorama {
 public:
  /// `cubes` in a frame whose z axis is up. What is far is drawn from as many points as its bins
  /// need. The bits do not depend on the order of the points.
  void draw(const PointCubes& cubes, const Eigen::Vector3f& position, const PanoramaShape& shape);

  /// First of the runs of a column (0 .. columns - 1) in a row.
  const float* range(int row, int column) const { return &range_[offset(row, column)]; }
  const float* intensity(int row, int column) const { return &intensity_[offset(row, column)]; }

 private:
  std::size_t offset(int row, int column) const {
    const int run = row * shape_.phases + column % shape_.phases;
    return static_cast<std::size_t>(run * 2 * shape_.headings + column / shape_.phases);
  }
  void drawPoints(const MapPoints& points, std::size_t begin, std::size_t end,
                  const Eigen::Vector3f& position);
  void offer(std::uint64_t point, int row, int first_column, int last_column);
  void arrangeByHeading();

  PanoramaShape shape_;
  std::vector<std::uint64_t> nearest_;    ///< [row][column]: bits of range, then of intensity
  std::vector<float> range_, intensity_;  ///< m (kUnknownRange: nothing); 0..255
};

/// Range where a panorama shows nothing.
constexpr float kUnknownRange = 1e6F;

}  // namespace pf
