// SPDX-License-Identifier: BSD-3-Clause
#include "disc_distance.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr std::size_t kBlocksAtOnce = 4;

/// Sums at the corners of a block.
struct CornerSums {
  std::array<float, BlockLattice::kCorners> nearest, weight, distance;
  std::array<Vector3f, BlockLattice::kCorners> side;  ///< normal of the nearest disc
};

void addDiscs(const DiscMaker& maker, const DiscBlocks& blocks, std::size_t i, CornerSums& sums,
              float* values) {
  sums.nearest.fill(std::numeric_limits<float>::max());
  sums.weight.fill(0);
  sums.distance.fill(0);
  const auto corner = [&](std::size_t, const Vector3i& at, Vector3f& point) {
    point = blocks.lattice.point(at);
    return true;
  };
  forEachPointOf(maker, blocks, i, corner,
                 [&](std::size_t at, const Disc& disc, const auto& where) {
                   const float distance = where.toDisc(disc.radius);
                   if (distance >= sums.nearest[at]) return;
                   sums.nearest[at] = distance;
                   sums.side[at] = disc.normal;
                 });
  forEachPointOf(maker, blocks, i, corner,
                 [&](std::size_t at, const Disc& disc, const auto& where) {
                   const float same_side = std::max(0.0F, disc.normal.dot(sums.side[at]));
                   const float weight = disc.weight * same_side * same_side * disc.closeness(where);
                   sums.weight[at] += weight;
                   sums.distance[at] += weight * where.above;
                 });
  for (std::size_t at = 0; at < BlockLattice::kCorners; ++at) {
    if (sums.weight[at] > 0) values[at] = sums.distance[at] / sums.weight[at];
  }
}

}  // namespace

DistanceField discDistance(const SurfelArrays& surfels, const DiscBlocks& blocks,
                           const MeshConfig& config) {
  const DiscMaker maker(surfels, config);
  DistanceField field(blocks.lattice);
  parallelFor(blocks.lattice.size(), kBlocksAtOnce, [&](std::size_t begin, std::size_t end) {
    CornerSums sums;
    for (std::size_t i = begin; i < end; ++i) {
      addDiscs(maker, blocks, i, sums, &field.values[i * BlockLattice::kCorners]);
    }
  });
  return field;
}

}  // namespace pf
