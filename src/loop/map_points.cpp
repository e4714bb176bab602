// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/map_points.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "point_arrays.hpp"

namespace pf {
namespace {

constexpr int kDensities = 3;

/// Voxel and facing, packed: 20 bits for each coordinate. Of surfels or points.
template <typename Arrays>
std::uint64_t cellOf(const Arrays& s, std::size_t i, float inverse_voxel) {
  const auto index = [&](float value) {
    constexpr std::int64_t kHalf = 1 << 19;
    const auto cell = static_cast<std::int64_t>(std::floor(value * inverse_voxel)) + kHalf;
    return static_cast<std::uint64_t>(std::clamp<std::int64_t>(cell, 0, 2 * kHalf - 1));
  };
  const float n[3] = {s.nx[i], s.ny[i], s.nz[i]};
  std::uint64_t axis = 0;
  for (std::uint64_t k = 1; k < 3; ++k) {
    if (std::abs(n[k]) > std::abs(n[axis])) axis = k;
  }
  const std::uint64_t facing = 2 * axis + (n[axis] < 0 ? 1 : 0);
  return ((facing << 20 | index(s.x[i])) << 20 | index(s.y[i])) << 20 | index(s.z[i]);
}

void set(MapPoints& points, std::size_t slot, const SurfelArrays& s, std::size_t i) {
  points.x[slot] = s.x[i];
  points.y[slot] = s.y[i];
  points.z[slot] = s.z[i];
  points.nx[slot] = s.nx[i];
  points.ny[slot] = s.ny[i];
  points.nz[slot] = s.nz[i];
  points.intensity[slot] = 0.299F * s.r[i] + 0.587F * s.g[i] + 0.114F * s.b[i];
}

}  // namespace

MapPoints thinnedPoints(const SurfelMap& map, int fragment, double voxel_m) {
  MapPoints points;
  points.voxel_m = static_cast<float>(voxel_m);
  std::unordered_map<std::uint64_t, std::size_t> slots;
  std::vector<float> support;
  map.forEachSurfelOf(fragment, [&](const SurfelArrays& s, std::size_t i) {
    if (!map.isStable(s, i) || map.isDead(s, i)) return;
    const auto [found, is_new] =
        slots.try_emplace(cellOf(s, i, 1.0F / points.voxel_m), support.size());
    if (is_new) {
      support.push_back(-1.0F);
      for (auto* array : pointArrays(points)) array->push_back(0.0F);
    }
    if (s.weight[i] <= support[found->second]) return;
    support[found->second] = s.weight[i];
    set(points, found->second, s, i);
  });
  return points;
}

MapPoints coarser(const MapPoints& points, double voxel_m) {
  MapPoints sums;
  sums.voxel_m = static_cast<float>(voxel_m);
  std::unordered_map<std::uint64_t, std::size_t> slots;
  std::vector<float> count;
  const auto from = pointArrays(points);
  const auto to = pointArrays(sums);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [found, is_new] =
        slots.try_emplace(cellOf(points, i, 1.0F / sums.voxel_m), count.size());
    if (is_new) {
      count.push_back(0.0F);
      for (auto* array : to) array->push_back(0.0F);
    }
    for (std::size_t k = 0; k < to.size(); ++k) (*to[k])[found->second] += (*from[k])[i];
    count[found->second] += 1.0F;
  }
  for (std::size_t i = 0; i < count.size(); ++i) {
    for (auto* array : {&sums.x, &sums.y, &sums.z, &sums.intensity}) (*array)[i] /= count[i];
    const float length = std::hypot(sums.nx[i], sums.ny[i], sums.nz[i]);
    for (auto* array : {&sums.nx, &sums.ny, &sums.nz}) (*array)[i] /= length;
  }
  return sums;
}

PointPyramid pointPyramid(MapPoints densest) {
  PointPyramid pyramid = {std::move(densest)};
  while (pyramid.size() < kDensities) {
    pyramid.push_back(coarser(pyramid.back(), 2.0 * pyramid.back().voxel_m));
  }
  return pyramid;
}

}  // namespace pf
