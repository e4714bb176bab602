// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/grid_check.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace pf {

double GridScore::share() const {
  return seen > 0 ? static_cast<double>(right) / static_cast<double>(seen) : 0.0;
}

GridScore checkGrid(const OccupancyGrid& grid, const GridConfig& config,
                    const Eigen::Isometry3d& T_truth_floor,
                    const std::vector<Eigen::Vector3f>& truth) {
  cv::Mat stands(grid.cells.size(), CV_8UC1, cv::Scalar(0));
  const Eigen::Isometry3d T_floor_truth = T_truth_floor.inverse();
  for (const Eigen::Vector3f& point : truth) {
    if (point.z() < config.lowest_m || point.z() > config.highest_m) continue;
    const Eigen::Vector3d p = T_floor_truth * point.cast<double>();
    const cv::Point cell(static_cast<int>(std::floor((p.x() - grid.low_x_m) / grid.cell_m)),
                         static_cast<int>(std::floor((p.y() - grid.low_y_m) / grid.cell_m)));
    if (cell.inside(cv::Rect({0, 0}, stands.size()))) stands.at<std::uint8_t>(cell) = 1;
  }
  cv::Mat beside, all_beside;
  cv::dilate(stands, beside, cv::Mat::ones(3, 3, CV_8UC1));
  cv::erode(stands, all_beside, cv::Mat::ones(3, 3, CV_8UC1));
  GridScore score;
  for (int y = 0; y < grid.cells.rows; ++y) {
    for (int x = 0; x < grid.cells.cols; ++x) {
      if (grid.at(x, y) == OccupancyGrid::kUnknown) continue;
      ++score.seen;
      const bool said = grid.at(x, y) == OccupancyGrid::kOccupied;
      if (said == (stands.at<std::uint8_t>(y, x) != 0)) {
        ++score.right;
        continue;
      }
      ++(said ? score.false_occupied : score.false_free);
      const bool near =
          said ? beside.at<std::uint8_t>(y, x) != 0 : all_beside.at<std::uint8_t>(y, x) == 0;
      score.near += near ? 1 : 0;
    }
  }
  return score;
}

}  // namespace pf
