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

/// The stable surfels of a region: where they are in space, and in the map. What else is asked of
/// them is read there: beside mapping, a second copy of the map is memory enough.
class StableSurfels {
 public:
  StableSurfels(const SurfelMap& map, const Region& region, const std::vector<char>& named)
      : map_(map), named_(named) {
    for (std::uint32_t block = 0; block < map.blocks().size(); ++block) {
      if (!region.has(block)) continue;
      const SurfelArrays& s = map.blocks()[block].surfels;
      for (std::uint32_t i = 0; i < s.size(); ++i) {
        if (!map.isStable(s, i)) continue;
        places_.push_back({block, i});
        positions_.emplace_back(s.x[i], s.y[i], s.z[i]);
        largest_radius_ = std::max(largest_radius_, s.radius[i]);
      }
    }
  }

  struct Place {
    std::uint32_t block, slot;
  };
  std::size_t size() const { return places_.size(); }
  const Place& place(std::size_t i) const { return places_[i]; }
  const std::vector<Eigen::Vector3f>& positions() const { return positions_; }

  /// What the line through surfel i along its normal meets within the distances of a layer.
  Eigen::AlignedBox3f boxOf(std::size_t i) const {
    return lineOf(i).box(kMostLayer_m, largest_radius_);
  }

  /// Whether i is a layer of the older k, one of them in a block that is asked about.
  bool isYoungerLayer(std::size_t i, std::size_t k) const {
    if (named_[places_[i].block] == 0 && named_[places_[k].block] == 0) return false;
    const SurfelArrays& other = surfelsOf(k);
    const std::uint32_t slot = places_[k].slot;
    if (other.created[slot] >= surfelsOf(i).created[places_[i].slot]) return false;
    float at = 0;
    if (!lineOf(i).meets(positions_[k], normalOf(k), other.radius[slot], kSameFacing, at)) {
      return false;
    }
    return std::abs(at) >= kLeastLayer_m && std::abs(at) <= kMostLayer_m;
  }

 private:
  const SurfelArrays& surfelsOf(std::size_t i) const {
    return map_.blocks()[places_[i].block].surfels;
  }
  Eigen::Vector3f normalOf(std::size_t i) const {
    const SurfelArrays& s = surfelsOf(i);
    const std::uint32_t slot = places_[i].slot;
    return {s.nx[slot], s.ny[slot], s.nz[slot]};
  }
  NormalLine lineOf(std::size_t i) const { return {positions_[i], normalOf(i)}; }

  const SurfelMap& map_;
  const std::vector<char>& named_;
  std::vector<Place> places_;
  std::vector<Eigen::Vector3f> positions_;
  float largest_radius_ = 0;
};

/// Marks those of a region that are to go. `first`: of each block's surfels among all of the map.
void findYoungerLayers(const StableSurfels& stable, const std::vector<std::size_t>& first,
                       std::vector<char>& doomed) {
  const PointGrid grid(stable.positions());
  parallelFor(stable.size(), kSurfelsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      char& gone = doomed[first[stable.place(i).block] + stable.place(i).slot];
      grid.visit(stable.boxOf(i), [&](std::size_t k) {
        if (gone == 0) gone = stable.isYoungerLayer(i, k);
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
  std::vector<std::size_t> first(1, 0);
  for (const SurfelBlock& block : map.blocks()) {
    first.push_back(first.back() + block.surfels.size());
  }
  for (const int fragment : fragments) {
    const Region region(map, fragment, is_named);
    if (!region.isEmpty()) findYoungerLayers(StableSurfels(map, region, is_named), first, doomed);
  }
  std::size_t index = 0;  // surfels come in the order of forEachSurfel()
  return map.removeIf([&](const SurfelArrays&, std::size_t) { return doomed[index++] != 0; });
}

}  // namespace pf
