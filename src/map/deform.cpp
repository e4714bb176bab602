// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/deform.hpp"

#include <algorithm>
#include <iterator>
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
      const auto& created = block.surfels.created;
      std::unique_copy(created.begin(), created.end(), std::back_inserter(frames_));
    }
    std::sort(frames_.begin(), frames_.end());
    frames_.erase(std::unique(frames_.begin(), frames_.end()), frames_.end());
    motions_.resize(frames_.size(), RigidMotion(Eigen::Isometry3d::Identity()));
    moves_.resize(frames_.size(), 0);
    parallelFor(frames_.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const Eigen::Isometry3d T = deformation.at(frames_[k]);
        motions_[k] = RigidMotion(T);
        moves_[k] = T.matrix() != Eigen::Matrix4d::Identity() ? 1 : 0;
      }
    });
  }

  /// Moves surfel i; false when its correction is the identity. `k` is where the search begins:
  /// neighbours are mostly of one frame.
  bool apply(SurfelArrays& s, std::size_t i, std::size_t& k) const {
    if (frames_[k] != s.created[i]) {
      const auto found = std::lower_bound(frames_.begin(), frames_.end(), s.created[i]);
      k = static_cast<std::size_t>(found - frames_.begin());
    }
    if (moves_[k] == 0) return false;
    motions_[k].point(s.x[i], s.y[i], s.z[i], s.x[i], s.y[i], s.z[i]);
    motions_[k].direction(s.nx[i], s.ny[i], s.nz[i], s.nx[i], s.ny[i], s.nz[i]);
    return true;
  }

 private:
  std::vector<std::int32_t> frames_;  // ascending, and for each:
  std::vector<RigidMotion> motions_;
  std::vector<char> moves_;
};

}  // namespace

void deform(SurfelMap& map, const Deformation& deformation) {
  if (deformation.isIdentity()) return;
  const Motions motions(map, deformation);
  std::vector<std::uint64_t> cells(map.blocks_.size());
  for (const auto& [cell, block] : map.index_) cells[block] = cell;
  std::vector<SurfelArrays> gone(map.blocks_.size());  // out of each block
  parallelFor(map.blocks_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      SurfelBlock& block = map.blocks_[b];
      SurfelArrays& s = block.surfels;
      std::vector<std::uint32_t> stay, leave;
      bool any = false;
      std::size_t hint = 0;
      for (std::size_t i = 0; i < s.size(); ++i) {
        const bool moved = motions.apply(s, i, hint);
        any |= moved;
        const bool left = moved && map.cellAt(s.x[i], s.y[i], s.z[i]) != cells[b];
        (left ? leave : stay).push_back(static_cast<std::uint32_t>(i));
      }
      if (!any) continue;
      gone[b].append(s, leave.data(), leave.size());
      map.keepOnly(stay, block);
    }
  });
  map.countMemory();
  SurfelArrays all;
  for (SurfelArrays& part : gone) {
    all.forEachArray(part, [](auto& array, const auto& more) {
      array.insert(array.end(), more.begin(), more.end());
    });
    part = {};
  }
  map.add(all);
}

}  // namespace pf
