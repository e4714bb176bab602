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

  /// Moves the surfels of a block whose correction is not the identity.
  void apply(SurfelBlock& block, std::vector<char>& moved) const {
    if (isOld(block)) return;
    SurfelArrays& s = block.surfels;
    std::size_t k = 0;  // where the search begins: neighbours are mostly of one frame
    for (std::size_t i = 0; i < s.size(); ++i) {
      const Origin origin(block.fragment, s.created[i]);
      if (origins_[k] != origin) {
        const auto found = std::lower_bound(origins_.begin(), origins_.end(), origin);
        k = static_cast<std::size_t>(found - origins_.begin());
      }
      if (moves_[k] == 0) continue;
      motions_[k].point(s.x[i], s.y[i], s.z[i], s.x[i], s.y[i], s.z[i]);
      motions_[k].direction(s.nx[i], s.ny[i], s.nz[i], s.nx[i], s.ny[i], s.nz[i]);
      moved[i] = 1;
    }
  }

 private:
  /// All that is in the block was there before anything that moves: a correction of the last step
  /// costs what was seen since, whatever the size of the map.
  bool isOld(const SurfelBlock& block) const {
    return block.changed < first_moved_.at(block.fragment);
  }

  using Origin = std::pair<int, std::int32_t>;  // fragment and frame
  std::map<int, std::int32_t> first_moved_;     // of each fragment
  std::vector<Origin> origins_;                 // ascending, and for each:
  std::vector<RigidMotion> motions_;
  std::vector<char> moves_;
};

}  // namespace

void deform(SurfelMap& map, const Deformation& deformation) {
  if (deformation.isIdentity()) return;
  const Motions motions(map, deformation);
  map.move([&](SurfelBlock& block, std::vector<char>& moved) { motions.apply(block, moved); },
           [&](int fragment) { return deformation.fragmentAfter(fragment); });
}

}  // namespace pf
