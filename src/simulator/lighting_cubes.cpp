// SPDX-License-Identifier: BSD-3-Clause
// Ambient light in the air of the rooms, for people.
#include <algorithm>
#include <cmath>

#include "posefusion/core/parallel.hpp"
#include "simulator/lighting.hpp"
#include "simulator/random.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector3f;

constexpr float kCubes_m = 0.7F;
constexpr int kCubeRays = 256;

/// The i-th of kCubeRays directions, evenly over the sphere (Fibonacci lattice).
Vector3f sphereDirection(int i) {
  const float z = 1.0F - (2.0F * static_cast<float>(i) + 1.0F) / kCubeRays;
  const float r = std::sqrt(std::max(0.0F, 1.0F - z * z));
  const float angle = 2.3999632F * static_cast<float>(i);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

}  // namespace

void Lighting::fillCubes() {
  Eigen::AlignedBox3f box;
  for (const auto& room : world_.rooms) box.extend(room.cast<float>());
  if (box.isEmpty()) return;
  cubes_from_ = box.min() + Vector3f::Constant(0.25F * kCubes_m);
  for (int i = 0; i < 3; ++i) {
    cubes_[i] = std::max(1, static_cast<int>(box.sizes()[i] / kCubes_m));
  }
  cube_.assign(static_cast<std::size_t>(cubes_.prod()), AmbientCube{});
  parallelFor(cube_.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const int index = static_cast<int>(k);
      const Eigen::Vector3i cell(index % cubes_.x(), index / cubes_.x() % cubes_.y(),
                                 index / (cubes_.x() * cubes_.y()));
      const Vector3f p = cubes_from_ + kCubes_m * cell.cast<float>();
      std::array<Vector3f, 6> sum;
      std::array<float, 6> weight{};
      sum.fill(Vector3f::Zero());
      for (int i = 0; i < kCubeRays; ++i) {
        const Vector3f d = sphereDirection(i);
        RTCRayHit ray{};
        ray.ray.org_x = p.x(), ray.ray.org_y = p.y(), ray.ray.org_z = p.z();
        ray.ray.dir_x = d.x(), ray.ray.dir_y = d.y(), ray.ray.dir_z = d.z();
        caster_.trace(ray);
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
        const Vector3f radiance = reflected(ray);
        for (int axis = 0; axis < 3; ++axis) {
          const auto side = static_cast<std::size_t>(2 * axis + (d[axis] < 0.0F ? 1 : 0));
          sum[side] += std::abs(d[axis]) * radiance;
          weight[side] += std::abs(d[axis]);
        }
      }
      for (std::size_t side = 0; side < 6; ++side) {
        cube_[k][side] = weight[side] > 0.0F ? Vector3f(sum[side] / weight[side]) : sum[side];
      }
    }
  });
}

AmbientCube Lighting::cubeAt(const Vector3f& position) const {
  AmbientCube result;
  result.fill(Vector3f::Zero());
  if (cube_.empty()) return result;
  const Vector3f g = (position - cubes_from_) / kCubes_m;
  Eigen::Vector3i low;
  Vector3f t;
  for (int i = 0; i < 3; ++i) {
    low[i] = std::clamp(static_cast<int>(std::floor(g[i])), 0, std::max(0, cubes_[i] - 2));
    t[i] = std::clamp(g[i] - static_cast<float>(low[i]), 0.0F, 1.0F);
  }
  for (int corner = 0; corner < 8; ++corner) {
    float weight = 1.0F;
    Eigen::Vector3i cell = low;
    for (int i = 0; i < 3; ++i) {
      const bool high = (corner >> i & 1) != 0;
      weight *= high ? t[i] : 1.0F - t[i];
      cell[i] = std::min(cell[i] + (high ? 1 : 0), cubes_[i] - 1);
    }
    const auto k =
        static_cast<std::size_t>(cell.x() + cubes_.x() * (cell.y() + cubes_.y() * cell.z()));
    for (std::size_t side = 0; side < 6; ++side) result[side] += weight * cube_[k][side];
  }
  return result;
}

}  // namespace pf::simulator
