// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core.hpp>

#include "posefusion/grid/config.hpp"
#include "posefusion/grid/keyframe_rays.hpp"
#include "posefusion/map/surfels.hpp"

namespace pf {

/// Cells seen from above, with the values of nav_msgs/OccupancyGrid.
struct OccupancyGrid {
  static constexpr std::int8_t kUnknown = -1, kFree = 0, kOccupied = 100;

  double cell_m = 0.05;
  double low_x_m = 0, low_y_m = 0;  ///< corner of cell (0, 0), in the frame of the floor
  cv::Mat cells;                    ///< CV_8SC1, row: y, column: x, both ascending

  std::int8_t at(int x, int y) const { return cells.at<std::int8_t>(y, x); }
  std::size_t count(std::int8_t state) const;
};

/// Gathers surfels and rays, all in the frame of the floor (floorFrame()).
class GridMaker {
 public:
  /// Sums up the surfels between the heights. Throws InputError where there are none at all, or
  /// they reach wider than GridConfig::largest_m.
  GridMaker(const SurfelArrays& surfels, const GridConfig& config);

  /// Cells that rays pass low and high, or on their way to the floor, are free: a ray under a table
  /// does not show that the space above it is.
  void add(const SeenPoints& seen);

  /// Occupied where surfels stand, else free where that was seen, else unknown.
  OccupancyGrid grid() const;

 private:
  void sumSurfels(const SurfelArrays& surfels);
  void addRay(const Eigen::Vector3f& from, const Eigen::Vector3f& to);
  Eigen::Vector2f cellOf(const Eigen::Vector3f& point) const;

  GridConfig config_;
  OccupancyGrid grid_;
  cv::Mat upright_, flat_;  ///< CV_32FC1: area (m^2) of surfels that face sideways, up or down
  cv::Mat low_rays_, high_rays_;  ///< CV_32SC1: up to GridConfig::clear_m and above
};

}  // namespace pf
