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

/// Squared distance of points to the line of a capsule.
struct SegmentDistance {
  Eigen::Vector3f start, direction;
  float inverse_length2;  // 0 for a point

  explicit SegmentDistance(const Capsule& c) : start(c.from), direction(c.to - c.from) {
    const float length2 = direction.squaredNorm();
    inverse_length2 = length2 > kMinLength2_m2 ? 1.0F / length2 : 0.0F;
  }
  float squared(float x, float y, float z) const {
    const float dx = x - start.x(), dy = y - start.y(), dz = z - start.z();
    const float t =
        std::clamp((dx * direction.x() + dy * direction.y() + dz * direction.z()) * inverse_length2,
                   0.0F, 1.0F);
    const float ex = dx - t * direction.x(), ey = dy - t * direction.y(),
                ez = dz - t * direction.z();
    return ex * ex + ey * ey + ez * ez;
  }
};

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
  for (std::size_t i = 0; i < people.size(); ++i) {
    const Body& body = people[i].body;
    for (const Capsule& capsule : body.capsules) {
      const SegmentDistance segment(capsule);
      const cv::Rect bounds = boundsOf(capsule, limit * capsule.radius_m, grid);
      const float inverse_radius = 1.0F / capsule.radius_m;
      parallelFor(std::max(0, bounds.height), kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
        for (int row = bounds.y + static_cast<int>(begin); row < bounds.y + static_cast<int>(end);
             ++row) {
          for (int col = bounds.x; col < bounds.x + bounds.width; ++col) {
            const int cell = row * grid.cols + col;
            const float z = grid.z[cell] > 0.0F ? grid.z[cell] : body.depth_m;
            const float relative =
                std::sqrt(segment.squared(grid.ray_x[cell] * z, grid.ray_y[cell] * z, z)) *
                inverse_radius;
            if (relative >= distance.relative[cell]) continue;
            distance.relative[cell] = relative;
            distance.owner[cell] = static_cast<std::int16_t>(i);
          }
        }
      });
    }
  }
}

}  // namespace pf
