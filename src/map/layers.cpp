// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/layers.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include "posefusion/core/normal_line.hpp"
#include "posefusion/core/parallel.hpp"
#include "posefusion/core/point_grid.hpp"

namespace pf {
namespace {

// What is closer is noise of one layer.
constexpr float kSameFacing = 0.8F;  // cosine
constexpr std::size_t kSurfelsAtOnce = 4096;

/// Which blocks of a fragment layers are looked for in: those named, and those around them.
class Region {
 public:
  Region(const SurfelMap& map, int fragment, const std::vector<char>& is_named)
      : map_(map), fragment_(fragment), is_named_(is_named) {
    for (std::size_t i = 0; i < map.blocks().size(); ++i) {
      if (is_named[i] == 0 || !isOfFragment(i)) continue;
      named_.push_back(map.blocks()[i].bounds);
      reach_ = std::max(reach_, kMostLayer_m + map.blocks()[i].largest_radius);
    }
  }

  bool isEmpty() const { return named_.empty(); }

  bool has(std::size_t block) const {
    if (!isOfFragment(block)) return false;
    if (is_named_[block] != 0) return true;
    const Eigen::AlignedBox3f& bounds = map_.blocks()[block].bounds;
    const float reach = std::max(reach_, kMostLayer_m + map_.blocks()[block].largest_radius);
    return std::any_of(named_.begin(), named_.end(), [&](const Eigen::AlignedBox3f& named) {
      return bounds.squaredExteriorDistance(named) <= reach * reach;
    });
  }

 private:
  bool isOfFragment(std::size_t block) const {
    return map_.blocks()[block].fragment == fragment_ && map_.blocks()[block].surfels.size() > 0;
  }

  const SurfelMap& map_;
  int fragment_;
  const std::vector<char>& is_named_;
  std::vector<Eigen::AlignedBox3f> named_;
  float reach_ = 0;
};

/// The stable surfels of a region, and where each is among all of the map.
struct StableSurfels {
  StableSurfels(const SurfelMap& map, const Region& region, const std::vector<char>& named) {
    std::size_t index = 0;
    for (std::size_t i = 0; i < map.blocks().size(); ++i) {
      const SurfelArrays& surfels = map.blocks()[i].surfels;
      if (region.has(i)) add(map, surfels, index, named[i]);
      index += surfels.size();
    }
  }

  void add(const SurfelMap& map, const SurfelArrays& s, std::size_t first, char named) {
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (!map.isStable(s, i)) continue;
      indices.push_back(first + i);
      is_named.push_back(named);
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
  std::vector<char> is_named;  ///< in one of the blocks that were asked about
  std::vector<Eigen::Vector3f> positions, normals;
  std::vector<float> radii;
  std::vector<std::int32_t> created;
  float largest_radius = 0;
};

/// Marks those of a region that are to go.
void findYoungerLayers(const StableSurfels& stable, std::vector<char>& doomed) {
  const PointGrid grid(stable.positions);
  parallelFor(stable.indices.size(), kSurfelsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      char& gone = doomed[stable.indices[i]];
      grid.visit(stable.lineOf(i).box(kMostLayer_m, stable.largest_radius), [&](std::size_t k) {
        const bool concerns = stable.is_named[i] != 0 || stable.is_named[k] != 0;
        if (concerns && stable.created[k] < stable.created[i] && gone == 0) {
          gone = stable.areLayers(i, k);
        }
      });
    }
  });
}

}  // namespace

std::size_t removeYoungerLayers(SurfelMap& map) { return removeYoungerLayers(map, allBlocks(map)); }

std::size_t removeYoungerLayers(SurfelMap& map, const std::vector<std::uint32_t>& blocks) {
  std::vector<char> is_named(map.blocks().size(), 0), doomed(map.size(), 0);
  std::set<int> fragments;
  for (const std::uint32_t block : blocks) {
    is_named[block] = 1;
    fragments.insert(map.blocks()[block].fragment);
  }
  for (const int fragment : fragments) {
    const Region region(map, fragment, is_named);
    if (!region.isEmpty()) findYoungerLayers(StableSurfels(map, region, is_named), doomed);
  }
  std::size_t index = 0;  // surfels come in the order of forEachSurfel()
  return map.removeIf([&](const SurfelArrays&, std::size_t) { return doomed[index++] != 0; });
}

}  // namespace pf
