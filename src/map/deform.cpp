// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/deform.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "posefusion/core/parallel.hpp"
#include "posefusion/core/rigid_motion.hpp"

namespace pf {
namespace {

/// The corrections of all frames that made a surfel.
class Motions {
 public:
  Motions(const SurfelMap& map, const Deformation& deformation) {
    for (const SurfelBlock& block : map.blocks()) {
      for (const std::int32_t frame : block.surfels.created) {
        const Origin origin(block.fragment, frame);
        if (origins_.empty() || origins_.back() != origin) origins_.push_back(origin);
      }
    }
    std::sort(origins_.begin(), origins_.end());
    origins_.erase(std::unique(origins_.begin(), origins_.end()), origins_.end());
    motions_.resize(origins_.size(), RigidMotion(Eigen::Isometry3d::Identity()));
    moves_.resize(origins_.size(), 0);
    parallelFor(origins_.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const auto& [fragment, frame] = origins_[k];
        const Eigen::Isometry3d T = deformation.at(frame, fragment);
        motions_[k] = RigidMotion(T);
        moves_[k] = T.matrix() != Eigen::Matrix4d::Identity() ? 1 : 0;
      }
    });
  }

  /// Moves surfel i of a block; false when its correction is the identity. `k` is where the search
  /// begins: neighbours are mostly of one frame.
  bool apply(SurfelBlock& block, std::size_t i, std::size_t& k) const {
    SurfelArrays& s = block.surfels;
    const Origin origin(block.fragment, s.created[i]);
    if (origins_[k] != origin) {
      const auto found = std::lower_bound(origins_.begin(), origins_.end(), origin);
      k = static_cast<std::size_t>(found - origins_.begin());
    }
    if (moves_[k] == 0) return false;
    motions_[k].point(s.x[i], s.y[i], s.z[i], s.x[i], s.y[i], s.z[i]);
    motions_[k].direction(s.nx[i], s.ny[i], s.nz[i], s.nx[i], s.ny[i], s.nz[i]);
    return true;
  }

 private:
  using Origin = std::pair<int, std::int32_t>;  // fragment and frame
  std::vector<Origin> origins_;                 // ascending, and for each:
  std::vector<RigidMotion> motions_;
  std::vector<char> moves_;
};

}  // namespace

void deform(SurfelMap& map, const Deformation& deformation) {
  if (deformation.isIdentity()) return;
  const Motions motions(map, deformation);
  std::vector<SurfelMap::Cell> cells(map.blocks_.size());
  for (const auto& [cell, block] : map.index_) cells[block] = cell;
  std::vector<SurfelArrays> gone(map.blocks_.size());  // out of each block
  parallelFor(map.blocks_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      SurfelBlock& block = map.blocks_[b];
      const SurfelArrays& s = block.surfels;
      const int fragment = deformation.fragmentAfter(block.fragment);
      std::vector<std::uint32_t> stay, leave;
      bool any = fragment != block.fragment;
      std::size_t hint = 0;
      for (std::size_t i = 0; i < s.size(); ++i) {
        const bool moved = motions.apply(block, i, hint);
        any |= moved;
        const bool left = fragment != block.fragment ||
                          (moved && !(map.cellAt(fragment, s.x[i], s.y[i], s.z[i]) == cells[b]));
        (left ? leave : stay).push_back(static_cast<std::uint32_t>(i));
      }
      if (!any) continue;
      gone[b].append(s, leave.data(), leave.size());
      map.keepOnly(stay, block);
    }
  });
  map.countMemory();
  std::map<int, SurfelArrays> all;  // by their new fragment
  for (std::size_t b = 0; b < gone.size(); ++b) {
    all[deformation.fragmentAfter(map.blocks_[b].fragment)].append(gone[b]);
    gone[b] = {};
  }
  for (const auto& [fragment, surfels] : all) map.add(surfels, fragment);
}

}  // namespace pf
