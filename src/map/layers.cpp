// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/layers.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
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
constexpr float kSmallest_m = 0.004F;  // radius that all of the smallest discs may have

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

/// The stable surfels of a region: where they are in the map. What is asked of them is read there:
/// beside mapping, a second copy of the map is memory enough.
class StableSurfels {
 public:
  StableSurfels(const SurfelMap& map, const Region& region, const std::vector<char>& named)
      : map_(map), named_(named) {
    for (std::uint32_t block = 0; block < map.blocks().size(); ++block) {
      if (!region.has(block)) continue;
      const SurfelArrays& s = map.blocks()[block].surfels;
      for (std::uint32_t i = 0; i < s.size(); ++i) {
        if (map.isStable(s, i)) places_.push_back({block, i});
      }
    }
  }

  struct Place {
    std::uint32_t block, slot;
  };
  std::size_t size() const { return places_.size(); }
  const Place& place(std::size_t i) const { return places_[i]; }
  Eigen::Vector3f position(std::size_t i) const {
    const SurfelArrays& s = surfelsOf(i);
    const std::uint32_t slot = places_[i].slot;
    return {s.x[slot], s.y[slot], s.z[slot]};
  }
  float radius(std::size_t i) const { return surfelsOf(i).radius[places_[i].slot]; }
  NormalLine lineOf(std::size_t i) const { return {position(i), normalOf(i)}; }

  /// Whether i is a layer of the older k, one of them in a block that is asked about.
  bool isYoungerLayer(std::size_t i, std::size_t k) const {
    if (named_[places_[i].block] == 0 && named_[places_[k].block] == 0) return false;
    const SurfelArrays& other = surfelsOf(k);
    const std::uint32_t slot = places_[k].slot;
    if (other.created[slot] >= surfelsOf(i).created[places_[i].slot]) return false;
    float at = 0;
    if (!lineOf(i).meets(position(k), normalOf(k), other.radius[slot], kSameFacing, at)) {
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

  const SurfelMap& map_;
  const std::vector<char>& named_;
  std::vector<Place> places_;
};

/// Those with discs of about one size, by place: a few large ones, far away, would have all be
/// looked for at their distance.
class Discs {
 public:
  Discs(const StableSurfels& stable, float from_radius, float to_radius)
      : reach_(to_radius),
        members_(membersOf(stable, from_radius, to_radius)),
        positions_(positionsOf(stable, members_)),
        grid_(positions_, kCellRadii * to_radius) {}

  /// Whether found(k) is true for a disc that a line may meet where layers are.
  template <typename Found>
  bool anyOnLine(const NormalLine& line, const Found& found) const {
    if (members_.empty()) return false;
    bool any = false;
    const float step = kCellRadii * reach_;
    for (float begin = kLeastLayer_m; begin < kMostLayer_m && !any; begin += step) {
      const float end = std::min(begin + step, kMostLayer_m);
      for (const float side : {-1.0F, 1.0F}) {
        grid_.visit(line.box(side * begin, side * end, reach_),
                    [&](std::size_t k) { any = any || found(members_[k]); });
      }
    }
    return any;
  }

 private:
  static constexpr float kCellRadii = 4.0F;

  static std::vector<std::uint32_t> membersOf(const StableSurfels& stable, float from_radius,
                                              float to_radius) {
    std::vector<std::uint32_t> members;
    for (std::size_t i = 0; i < stable.size(); ++i) {
      const float radius = stable.radius(i);
      if (radius > from_radius && radius <= to_radius) {
        members.push_back(static_cast<std::uint32_t>(i));
      }
    }
    return members;
  }
  static std::vector<Eigen::Vector3f> positionsOf(const StableSurfels& stable,
                                                  const std::vector<std::uint32_t>& members) {
    std::vector<Eigen::Vector3f> positions;
    positions.reserve(members.size());
    for (const std::uint32_t i : members) positions.push_back(stable.position(i));
    return positions;
  }

  float reach_;
  std::vector<std::uint32_t> members_;  ///< numbers in StableSurfels
  std::vector<Eigen::Vector3f> positions_;
  PointGrid grid_;
};

/// Marks those of a region that are to go. `first`: of each block's surfels among all of the map.
void findYoungerLayers(const StableSurfels& stable, const std::vector<std::size_t>& first,
                       std::vector<char>& doomed) {
  float largest = 0;
  for (std::size_t i = 0; i < stable.size(); ++i) largest = std::max(largest, stable.radius(i));
  std::deque<Discs> sizes;
  for (float from = 0, to = kSmallest_m; from < largest; from = to, to *= 2) {
    sizes.emplace_back(stable, from, to);
  }
  parallelFor(stable.size(), kSurfelsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const NormalLine line = stable.lineOf(i);
      doomed[first[stable.place(i).block] + stable.place(i).slot] =
          std::any_of(sizes.begin(), sizes.end(), [&](const Discs& discs) {
            return discs.anyOnLine(line,
                                   [&](std::size_t k) { return stable.isYoungerLayer(i, k); });
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
