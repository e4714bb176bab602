// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/layers.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "posefusion/core/normal_line.hpp"
#include "posefusion/core/parallel.hpp"
#include "posefusion/core/point_grid.hpp"

namespace pf {
namespace {

// What is closer is noise of one layer.
constexpr float kSameFacing = 0.8F;  // cosine
constexpr std::size_t kGrain = 4096;

/// The stable surfels of a fragment, and where each is among all of the map.
struct StableSurfels {
  StableSurfels(const SurfelMap& map, int fragment) {
    std::size_t index = 0;
    for (const SurfelBlock& block : map.blocks()) {
      if (block.fragment == fragment) add(map, block.surfels, index);
      index += block.surfels.size();
    }
  }

  void add(const SurfelMap& map, const SurfelArrays& s, std::size_t first) {
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (!map.isStable(s, i)) continue;
      indices.push_back(first + i);
      positions.emplace_back(s.x[i], s.y[i], s.z[i]);
      normals.emplace_back(s.nx[i], s.ny[i], s.nz[i]);
      radii.push_back(s.radius[i]);
      created.push_back(s.created[i]);
      largest_radius = std::max(largest_radius, s.radius[i]);
    }
  }

  /// Whether the line through surfel i along its normal meets the disc of k within the distances of
  /// a layer.
  bool areLayers(std::size_t i, std::size_t k) const {
    float at = 0;
    if (!lineOf(i).meets(positions[k], normals[k], radii[k], kSameFacing, at)) return false;
    return std::abs(at) >= kLeastLayer_m && std::abs(at) <= kMostLayer_m;
  }

  NormalLine lineOf(std::size_t i) const { return {positions[i], normals[i]}; }

  std::vector<std::size_t> indices;
  std::vector<Eigen::Vector3f> positions, normals;
  std::vector<float> radii;
  std::vector<std::int32_t> created;
  float largest_radius = 0;
};

/// Marks those of a fragment that are to go.
void findYoungerLayers(const SurfelMap& map, int fragment, std::vector<char>& doomed) {
  const StableSurfels stable(map, fragment);
  const PointGrid grid(stable.positions);
  parallelFor(stable.indices.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      char& gone = doomed[stable.indices[i]];
      grid.visit(stable.lineOf(i).box(kMostLayer_m, stable.largest_radius), [&](std::size_t k) {
        if (stable.created[k] < stable.created[i] && gone == 0) gone = stable.areLayers(i, k);
      });
    }
  });
}

}  // namespace

std::size_t removeYoungerLayers(SurfelMap& map) {
  std::set<int> fragments;
  for (const SurfelBlock& block : map.blocks()) fragments.insert(block.fragment);
  std::vector<char> doomed(map.size(), 0);
  for (const int fragment : fragments) findYoungerLayers(map, fragment, doomed);
  std::size_t index = 0;  // surfels come in the order of forEachSurfel()
  return map.removeIf([&](const SurfelArrays&, std::size_t) { return doomed[index++] != 0; });
}

}  // namespace pf
