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

constexpr std::size_t kGrain = 4;

/// What the corners of a block are told.
struct Told {
  std::array<float, BlockLattice::kCorners> nearest, weight, distance;
  std::array<Vector3f, BlockLattice::kCorners> side;  ///< normal of the nearest disc
};

void tell(const DiscMaker& maker, const DiscBlocks& blocks, std::size_t i, Told& told,
          float* values) {
  told.nearest.fill(std::numeric_limits<float>::max());
  told.weight.fill(0);
  told.distance.fill(0);
  const auto corner = [&](std::size_t, const Vector3i& at, Vector3f& point) {
    point = blocks.lattice.point(at);
    return true;
  };
  forEachPointOf(maker, blocks, i, corner,
                 [&](std::size_t at, const Disc& disc, const auto& where) {
                   const float distance = where.toDisc(disc.radius);
                   if (distance >= told.nearest[at]) return;
                   told.nearest[at] = distance;
                   told.side[at] = disc.normal;
                 });
  forEachPointOf(maker, blocks, i, corner,
                 [&](std::size_t at, const Disc& disc, const auto& where) {
                   const float same_side = std::max(0.0F, disc.normal.dot(told.side[at]));
                   const float weight = disc.weight * same_side * same_side * disc.closeness(where);
                   told.weight[at] += weight;
                   told.distance[at] += weight * where.above;
                 });
  for (std::size_t at = 0; at < BlockLattice::kCorners; ++at) {
    if (told.weight[at] > 0) values[at] = told.distance[at] / told.weight[at];
  }
}

}  // namespace

DistanceField discDistance(const SurfelArrays& surfels, const DiscBlocks& blocks,
                           const MeshConfig& config) {
  const DiscMaker maker(surfels, config);
  DistanceField field(blocks.lattice);
  parallelFor(blocks.lattice.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    Told told;
    for (std::size_t i = begin; i < end; ++i) {
      tell(maker, blocks, i, told, &field.values[i * BlockLattice::kCorners]);
    }
  });
  return field;
}

}  // namespace pf
