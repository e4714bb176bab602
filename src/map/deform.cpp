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
  Motions(const SurfelMap& map, const Deformation& deformation,
          const std::vector<std::uint32_t>& blocks) {
    for (const std::uint32_t number : blocks) {
      const SurfelBlock& block = map.blocks()[number];
      const auto [first, is_new] = first_moved_.try_emplace(block.fragment, 0);
      if (is_new) first->second = deformation.firstMoved(block.fragment);
      if (isOld(block)) continue;
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

  /// Whether the correction of any surfel of a block is not the identity.
  bool moves(const SurfelBlock& block) const {
    if (isOld(block)) return false;
    const auto& created = block.surfels.created;
    std::size_t k = 0;
    return std::any_of(created.begin(), created.end(), [&](std::int32_t frame) {
      return moves_[k = find({block.fragment, frame}, k)] != 0;
    });
  }

  /// Moves the surfels of a block whose correction is not the identity.
  void apply(SurfelArrays& s, int fragment) const {
    std::size_t k = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
      k = find({fragment, s.created[i]}, k);
      if (moves_[k] == 0) continue;
      motions_[k].point(s.x[i], s.y[i], s.z[i], s.x[i], s.y[i], s.z[i]);
      motions_[k].direction(s.nx[i], s.ny[i], s.nz[i], s.nx[i], s.ny[i], s.nz[i]);
    }
  }

 private:
  /// All that is in the block was there before anything that moves: a correction of the last step
  /// costs what was seen since, whatever the size of the map.
  bool isOld(const SurfelBlock& block) const {
    return block.changed < first_moved_.at(block.fragment);
  }

  using Origin = std::pair<int, std::int32_t>;  // fragment and frame

  /// Where its motion is. `last`: of the surfel before, which mostly is of the same frame.
  std::size_t find(const Origin& origin, std::size_t last) const {
    if (origins_[last] == origin) return last;
    const auto found = std::lower_bound(origins_.begin(), origins_.end(), origin);
    return static_cast<std::size_t>(found - origins_.begin());
  }

  std::map<int, std::int32_t> first_moved_;  // of each fragment
  std::vector<Origin> origins_;              // ascending, and for each:
  std::vector<RigidMotion> motions_;
  std::vector<char> moves_;
};

}  // namespace

void deform(SurfelMap& map, const Deformation& deformation) {
  deform(map, deformation, allBlocks(map));
}

void deform(SurfelMap& map, const Deformation& deformation,
            const std::vector<std::uint32_t>& blocks) {
  if (deformation.isIdentity()) return;
  const Motions motions(map, deformation, blocks);
  map.move({[&](const SurfelBlock& block) { return motions.moves(block); },
            [&](SurfelArrays& surfels, int fragment) { motions.apply(surfels, fragment); },
            [&](int fragment) { return deformation.fragmentAfter(fragment); }},
           blocks);
}

}  // namespace pf
