// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/body_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr float kMinPartDepth_m = 0.2F;      // nearer parts of a capsule cover no more of the view
constexpr float kReachTowardsCamera = 0.5F;  // of a capsule's reach, where its bounds are taken
constexpr float kMinLength2_m2 = 1e-8F;      // a shorter capsule is a point

/// A capsule's line, and the part of the grid that its reach can cover.
struct Line {
  float start[3], direction[3];
  float inverse_length2;  // 0 for a point
  float inverse_radius;
  float depth_m;  // of cells without any
  std::int16_t owner;
  cv::Rect bounds;

  Line(const Capsule& c, float body_depth_m, std::size_t person)
      : inverse_radius(1.0F / c.radius_m),
        depth_m(body_depth_m),
        owner(static_cast<std::int16_t>(person)) {
    const Eigen::Vector3f along = c.to - c.from;
    for (int i = 0; i < 3; ++i) {
      start[i] = c.from[i];
      direction[i] = along[i];
    }
    const float length2 = along.squaredNorm();
    inverse_length2 = length2 > kMinLength2_m2 ? 1.0F / length2 : 0.0F;
  }
};

/// Cells of one row, one after another.
struct RowOfCells {
  const float *ray_x, *ray_y, *z;
  float* relative;
  std::int16_t* owner;
  int count;
};

POSEFUSION_SIMD_CLONES
void measureRow(const Line& line, const RowOfCells& row) {
  for (int i = 0; i < row.count; ++i) {
    const float z = row.z[i] > 0.0F ? row.z[i] : line.depth_m;
    const float dx = row.ray_x[i] * z - line.start[0];
    const float dy = row.ray_y[i] * z - line.start[1];
    const float dz = z - line.start[2];
    const float along = (dx * line.direction[0] + dy * line.direction[1] + dz * line.direction[2]) *
                        line.inverse_length2;
    const float from_start = along < 0.0F ? 0.0F : along;
    const float t = from_start > 1.0F ? 1.0F : from_start;
    const float ex = dx - t * line.direction[0], ey = dy - t * line.direction[1],
                ez = dz - t * line.direction[2];
    const float relative = std::sqrt(ex * ex + ey * ey + ez * ez) * line.inverse_radius;
    const bool is_nearer = relative < row.relative[i];
    row.relative[i] = is_nearer ? relative : row.relative[i];
    row.owner[i] = is_nearer ? line.owner : row.owner[i];
  }
}

/// Columns and rows that a capsule with its reach can cover.
cv::Rect boundsOf(const Capsule& capsule, float reach_m, const SceneGrid& grid) {
  constexpr float kFar = std::numeric_limits<float>::max();
  float left = kFar, right = -kFar, top = kFar, bottom = -kFar;
  const float step_x = grid.spacing, step_y = grid.ray_y[grid.cols] - grid.ray_y[0];
  for (const Eigen::Vector3f& p : {capsule.from, capsule.to}) {
    const float z = std::max(kMinPartDepth_m, p.z() - kReachTowardsCamera * reach_m);
    const float col = (p.x() / p.z() - grid.ray_x[0]) / step_x;
    const float row = (p.y() / p.z() - grid.ray_y[0]) / step_y;
    left = std::min(left, col - reach_m / z / step_x);
    right = std::max(right, col + reach_m / z / step_x);
    top = std::min(top, row - reach_m / z / step_y);
    bottom = std::max(bottom, row + reach_m / z / step_y);
  }
  const auto inside = [](float value, int limit) {
    return static_cast<int>(std::clamp(value, 0.0F, static_cast<float>(limit)));
  };
  const int x0 = inside(left, grid.cols), y0 = inside(top, grid.rows);
  return {x0, y0, inside(right + 1.0F, grid.cols) - x0, inside(bottom + 1.0F, grid.rows) - y0};
}

}  // namespace

void measureDistance(const std::vector<TrackedPerson>& people, const SceneGrid& grid, float limit,
                     BodyDistance& distance) {
  distance.relative.assign(grid.size(), limit);
  distance.owner.assign(grid.size(), -1);
  std::vector<Line> lines;
  for (std::size_t i = 0; i < people.size(); ++i) {
    for (const Capsule& capsule : people[i].body.capsules) {
      lines.emplace_back(capsule, people[i].body.depth_m, i);
      lines.back().bounds = boundsOf(capsule, limit * capsule.radius_m, grid);
    }
  }
  parallelFor(grid.rows, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (const Line& line : lines) {
        const cv::Rect& b = line.bounds;
        if (y < b.y || y >= b.y + b.height) continue;
        const int cell = y * grid.cols + b.x;
        measureRow(line, {&grid.ray_x[cell], &grid.ray_y[cell], &grid.z[cell],
                          &distance.relative[cell], &distance.owner[cell], b.width});
      }
    }
  });
}

}  // namespace pf
