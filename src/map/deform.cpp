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

/// Positions and normals of surfels that lie one after the other.
struct Run {
  float *x, *y, *z, *nx, *ny, *nz;
  std::size_t count;
};

POSEFUSION_SIMD_CLONES
void moveRun(const float* r, const float* t, const Run& run) {
  float* __restrict x = run.x, * __restrict y = run.y, * __restrict z = run.z;
  float* __restrict nx = run.nx, * __restrict ny = run.ny, * __restrict nz = run.nz;
  for (std::size_t i = 0; i < run.count; ++i) {
    const float px = x[i], py = y[i], pz = z[i];
    x[i] = r[0] * px + r[1] * py + r[2] * pz + t[0];
    y[i] = r[3] * px + r[4] * py + r[5] * pz + t[1];
    z[i] = r[6] * px + r[7] * py + r[8] * pz + t[2];
    const float a = nx[i], b = ny[i], c = nz[i];
    nx[i] = r[0] * a + r[1] * b + r[2] * c;
    ny[i] = r[3] * a + r[4] * b + r[5] * c;
    nz[i] = r[6] * a + r[7] * b + r[8] * c;
  }
}

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
    for (std::size_t i = 0, end = 0; i < s.size(); i = end) {
      while (end < s.size() && s.created[end] == s.created[i]) ++end;
      k = find({fragment, s.created[i]}, k);
      if (moves_[k] == 0) continue;
      moveRun(motions_[k].rotation(), motions_[k].translation(),
              {&s.x[i], &s.y[i], &s.z[i], &s.nx[i], &s.ny[i], &s.nz[i], end - i});
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
  SurfelMap::Mover mover{
      [&](const SurfelBlock& block) { return motions.moves(block); },
      [&](SurfelArrays& surfels, int fragment) { motions.apply(surfels, fragment); }};
  if (deformation.joins()) {
    mover.fragment_after = [&](int fragment) { return deformation.fragmentAfter(fragment); };
  }
  map.move(mover, blocks);
}

}  // namespace pf
