// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/people_in_map.hpp"

#include <algorithm>
#include <utility>

#include "posefusion/core/stamps.hpp"

namespace pf {
namespace {

constexpr int kReach = 2;  // cells from a joint to the mask that it is of

/// Median depth of the mask around a cell, 0 where there is none of it.
float depthBeside(int cell, const std::vector<std::uint8_t>& mask, const SceneGrid& grid) {
  std::vector<float> depths;
  const int u = cell % grid.cols, v = cell / grid.cols;
  for (int y = std::max(0, v - kReach); y <= std::min(grid.rows - 1, v + kReach); ++y) {
    for (int x = std::max(0, u - kReach); x <= std::min(grid.cols - 1, u + kReach); ++x) {
      const int other = y * grid.cols + x;
      if (mask[other] != 0 && grid.hasDepth(other)) depths.push_back(grid.z[other]);
    }
  }
  if (depths.empty()) return 0.0F;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

}  // namespace

SkeletonPoints liftSkeleton(const Person& person, const std::vector<int>& cells,
                            const SceneGrid& grid) {
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(grid.size()), 0);
  for (const int cell : cells) mask[static_cast<std::size_t>(cell)] = 1;
  SkeletonPoints points = unknownSkeleton();
  for (std::size_t j = 0; j < points.size(); ++j) {
    const Keypoint& joint = person.joints[j];
    const int cell = joint.p > 0 ? grid.cellAt(joint.u, joint.v) : -1;
    const float z = cell < 0 ? 0.0F : depthBeside(cell, mask, grid);
    if (z > 0) points[j] = {grid.ray_x[cell] * z, grid.ray_y[cell] * z, z};
  }
  return points;
}

std::vector<MovingObject> PeopleInMap::place(const std::vector<TrackedPerson>& people,
                                             const SceneGrid& grid,
                                             const Eigen::Isometry3d& T_uncorrected_camera,
                                             std::int64_t stamp_ns) {
  const double elapsed_s = secondsBetween(last_ns_, stamp_ns);
  const Eigen::Isometry3f T = T_uncorrected_camera.cast<float>();
  std::vector<MovingObject> placed;
  for (const TrackedPerson& tracked : people) {
    std::vector<Eigen::Vector3f> points_m;
    for (const int cell : tracked.cells) {
      if (grid.hasDepth(cell)) points_m.emplace_back(T * grid.point(cell));
    }
    if (points_m.empty()) continue;
    const auto before = std::find_if(last_.begin(), last_.end(), [&](const MovingObject& object) {
      return object.id == tracked.id;
    });
    MovingObject person = before == last_.end() ? MovingObject() : *before;
    person.id = tracked.id;
    person.is_person = true;
    person.placeAt(std::move(points_m), elapsed_s);
    person.joints_m = liftSkeleton(tracked.person, tracked.cells, grid);
    for (Eigen::Vector3f& joint : person.joints_m) joint = T * joint;
    placed.push_back(std::move(person));
  }
  last_ = placed;
  last_ns_ = stamp_ns;
  return placed;
}

}  // namespace pf
