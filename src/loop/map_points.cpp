// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/map_points.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace pf {
namespace {

/// Voxel and facing, packed: 20 bits for each coordinate.
std::uint64_t cellOf(const SurfelArrays& s, std::size_t i, float inverse_voxel) {
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

/// Sum of the normals within an angle of a direction.
struct Bundle {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::size_t count = 0;
};

Bundle around(const Normals& n, const Eigen::Vector3d& direction, double min_cosine,
              std::size_t stride = 1) {
  Bundle bundle;
  for (std::size_t i = 0; i < n.count; i += stride) {
    const Eigen::Vector3d normal(n.x[i], n.y[i], n.z[i]);
    if (normal.dot(direction) < min_cosine) continue;
    bundle.sum += normal;
    ++bundle.count;
  }
  return bundle;
}

}  // namespace

MapPoints thinnedPoints(const SurfelMap& map, double voxel_m) {
  MapPoints points;
  points.voxel_m = static_cast<float>(voxel_m);
  std::unordered_map<std::uint64_t, std::size_t> slots;
  std::vector<float> support;
  map.forEachSurfel([&](const SurfelArrays& s, std::size_t i) {
    if (!map.isStable(s, i) || map.isDead(s, i)) return;
    const auto [found, is_new] =
        slots.try_emplace(cellOf(s, i, 1.0F / points.voxel_m), support.size());
    if (is_new) {
      support.push_back(-1.0F);
      for (auto* array : {&points.x, &points.y, &points.z, &points.nx, &points.ny, &points.nz,
                          &points.intensity}) {
        array->push_back(0.0F);
      }
    }
    if (s.confidence[i] <= support[found->second]) return;
    support[found->second] = s.confidence[i];
    set(points, found->second, s, i);
  });
  return points;
}

std::optional<Eigen::Vector3d> levelDirection(const Normals& normals, const Eigen::Vector3d& guess,
                                              double max_angle_rad, double least) {
  constexpr double kTries = 200, kMaxVoters = 2000, kBundle_rad = 0.105;
  constexpr int kMeanSteps = 3;
  const double min_cosine = std::cos(max_angle_rad), bundle_cosine = std::cos(kBundle_rad);
  const auto stride = [&](double most) {
    return std::max<std::size_t>(
        1, static_cast<std::size_t>(static_cast<double>(normals.count) / most));
  };
  Eigen::Vector3d best = guess.normalized();
  std::size_t most = 0;
  for (std::size_t i = 0; i < normals.count; i += stride(kTries)) {
    const Eigen::Vector3d candidate(normals.x[i], normals.y[i], normals.z[i]);
    if (candidate.dot(guess.normalized()) < min_cosine) continue;
    const std::size_t votes = around(normals, candidate, bundle_cosine, stride(kMaxVoters)).count;
    if (votes <= most) continue;
    most = votes;
    best = candidate;
  }
  Bundle bundle;
  for (int i = 0; i < kMeanSteps && most > 0; ++i) {
    bundle = around(normals, best, bundle_cosine);
    if (bundle.count > 0) best = bundle.sum.normalized();
  }
  if (static_cast<double>(bundle.count) < least * static_cast<double>(normals.count)) return {};
  if (bundle.count == 0 || best.dot(guess.normalized()) < min_cosine) return {};
  return best;
}

}  // namespace pf
