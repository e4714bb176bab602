// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/grid/occupancy_grid.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "posefusion/core/error.hpp"

namespace pf {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr double kMargin_m = 0.2;
constexpr int kLeastRays = 2;  // one may go through a gap between surfels
// Less surface in a cell is no obstacle: shares of the cell's own area.
constexpr double kLeastUpright = 1.0, kLeastFlat = 0.25;
constexpr float kFlat = 0.707F;  // 45 degrees
// A wall stands in the cell that most of it is in, not in one that its noise reaches.
constexpr double kShareOfNeighbour = 0.15;
// A ray ends before the surface that it meets, in cells.
constexpr float kBeforeEnd = 1.0F;
constexpr int kFillFrom = 5, kFillRounds = 3;
constexpr float kStep = 0.5F;  // along a ray, cells

/// Of the positions that are numbers.
Eigen::AlignedBox2d boundsOf(const SurfelArrays& s) {
  Eigen::AlignedBox2d box;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Eigen::Vector2d p(s.x[i], s.y[i]);
    if (p.allFinite()) box.extend(p);
  }
  if (box.isEmpty()) throw InputError("grid: the map has no stable surfels, expected some");
  return box;
}

/// Gaps between surfels that were seen from far: cells of which five neighbours are occupied are.
void fillGaps(cv::Mat& cells) {
  cv::Mat occupied = (cells == OccupancyGrid::kOccupied) / 255, around;
  cv::boxFilter(occupied, around, CV_8U, {3, 3}, {-1, -1}, false, cv::BORDER_CONSTANT);
  cells.setTo(OccupancyGrid::kOccupied, around >= kFillFrom);
}

}  // namespace

void validate(const GridConfig& c) {
  require(c.cell_m >= 0.001 && c.cell_m <= 10, "grid: cell:", c.cell_m, "0.001 to 10 m");
  require(c.lowest_m >= 0 && c.lowest_m < c.highest_m, "grid: lowest:", c.lowest_m,
          "0 m to less than highest");
  require(c.highest_m <= 100, "grid: highest:", c.highest_m, "at most 100 m");
  require(c.clear_m >= c.lowest_m, "grid: clear:", c.clear_m, "at least lowest");
}

std::size_t OccupancyGrid::count(std::int8_t state) const {
  return static_cast<std::size_t>(cv::countNonZero(cells == state));
}

GridMaker::GridMaker(const SurfelArrays& surfels, const GridConfig& config) : config_(config) {
  validate(config);
  const Eigen::AlignedBox2d box = boundsOf(surfels);
  const double side_m = box.sizes().maxCoeff();
  if (side_m > config.largest_m) {
    throw InputError("grid: the map is " + std::to_string(std::lround(side_m)) +
                     " m wide, expected at most " + std::to_string(std::lround(config.largest_m)));
  }
  const auto cells = [&](double m) { return std::floor(m / config.cell_m); };
  grid_.cell_m = config.cell_m;
  grid_.low_x_m = config.cell_m * (cells(box.min().x() - kMargin_m));
  grid_.low_y_m = config.cell_m * (cells(box.min().y() - kMargin_m));
  const cv::Size size(static_cast<int>(cells(box.max().x() + kMargin_m - grid_.low_x_m)) + 1,
                      static_cast<int>(cells(box.max().y() + kMargin_m - grid_.low_y_m)) + 1);
  constexpr double kMostCells = 1e8;
  require(static_cast<double>(size.width) * size.height <= kMostCells, "grid: cell:", config.cell_m,
          "one that gives at most 100 million cells");
  upright_ = cv::Mat(size, CV_32FC1, cv::Scalar(0));
  flat_ = cv::Mat(size, CV_32FC1, cv::Scalar(0));
  low_rays_ = cv::Mat(size, CV_32SC1, cv::Scalar(0));
  high_rays_ = cv::Mat(size, CV_32SC1, cv::Scalar(0));
  sumSurfels(surfels);
}

Vector2f GridMaker::cellOf(const Vector3f& point) const {
  return {static_cast<float>((point.x() - grid_.low_x_m) / grid_.cell_m),
          static_cast<float>((point.y() - grid_.low_y_m) / grid_.cell_m)};
}

void GridMaker::sumSurfels(const SurfelArrays& s) {
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Vector3f p(s.x[i], s.y[i], s.z[i]);
    if (!p.allFinite() || !std::isfinite(s.radius[i]) || p.z() < config_.lowest_m ||
        p.z() > config_.highest_m)
      continue;
    const Vector2f cell = cellOf(p);
    cv::Mat& area_m2 = std::abs(s.nz[i]) > kFlat ? flat_ : upright_;
    area_m2.at<float>(static_cast<int>(cell.y()), static_cast<int>(cell.x())) +=
        static_cast<float>(M_PI) * s.radius[i] * s.radius[i];
  }
}

void GridMaker::add(const SeenPoints& seen) {
  for (const Vector3f& point : seen.points) addRay(seen.from, point);
}

void GridMaker::addRay(const Vector3f& from, const Vector3f& to) {
  const auto clear = static_cast<float>(config_.clear_m);
  const auto highest = static_cast<float>(config_.highest_m);
  const Vector2f a = cellOf(from), step = cellOf(to) - a;
  const float length = step.norm();
  const bool ends_on_floor = std::abs(to.z()) < config_.lowest_m;
  const float end = ends_on_floor ? length : length - kBeforeEnd;
  cv::Point last(-1, -1);
  for (float at = 0; at <= end && length > 0; at += kStep) {
    const Vector2f p = a + at / length * step;
    const cv::Point cell(static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y())));
    if (cell == last || !cell.inside(cv::Rect({0, 0}, low_rays_.size()))) continue;
    last = cell;
    const float height = from.z() + at / length * (to.z() - from.z());
    if (height > highest) continue;
    ++(height <= clear ? low_rays_ : high_rays_).at<int>(cell);
  }
}

OccupancyGrid GridMaker::grid() const {
  cv::Mat most;
  cv::dilate(upright_, most, cv::Mat::ones(3, 3, CV_8UC1));
  const double cell_m2 = config_.cell_m * config_.cell_m;
  OccupancyGrid grid = grid_;
  grid.cells = cv::Mat(flat_.size(), CV_8SC1, cv::Scalar(OccupancyGrid::kUnknown));
  grid.cells.setTo(OccupancyGrid::kFree, (low_rays_ >= kLeastRays) & (high_rays_ >= kLeastRays));
  grid.cells.setTo(OccupancyGrid::kOccupied, flat_ >= kLeastFlat * cell_m2);
  grid.cells.setTo(OccupancyGrid::kOccupied,
                   (upright_ >= kLeastUpright * cell_m2) & (upright_ >= kShareOfNeighbour * most));
  for (int round = 0; round < kFillRounds; ++round) fillGaps(grid.cells);
  return grid;
}

}  // namespace pf
