// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "posefusion/map/surfels.hpp"
#include "posefusion/mesh/block_lattice.hpp"
#include "posefusion/mesh/config.hpp"

namespace pf {

/// A surfel as a mesh is made of it. It reaches as far as a flat cylinder: up to `reach` beside
/// its centre and up to `depth` before and behind it (m).
struct Disc {
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  float radius = 0, reach = 0, depth = 0;
  float weight = 0;
  Eigen::Vector3f color = Eigen::Vector3f::Zero();  ///< 0..255; not finite: none

  /// Where a point lies to it.
  struct Place {
    float above = 0;   ///< along the normal, m
    float beside = 0;  ///< squared, m^2

    /// To the disc, squared, m^2.
    float toDisc(float radius) const {
      if (beside <= radius * radius) return above * above;
      const float rim = std::sqrt(beside) - radius;
      return above * above + rim * rim;
    }
  };

  /// False outside of the cylinder.
  bool holds(const Eigen::Vector3f& point, Place& place) const {
    const Eigen::Vector3f step = point - center;
    place.above = normal.dot(step);
    if (std::abs(place.above) > depth) return false;
    place.beside = std::max(0.0F, step.squaredNorm() - place.above * place.above);
    return place.beside <= reach * reach;
  }

  /// Falls smoothly from 1 at the centre to 0 at the hull of the cylinder.
  float closeness(const Place& place) const {
    const float beside = 1.0F - place.beside / (reach * reach);
    const float above = 1.0F - place.above * place.above / (depth * depth);
    return beside * beside * beside * beside * above;
  }
};

/// Cells of a lattice, `low` to `high` along each axis.
struct CellRange {
  Eigen::Vector3i low, high;
};

/// Surfels as discs.
class DiscMaker {
 public:
  DiscMaker(const SurfelArrays& surfels, const MeshConfig& config);

  /// No point that a disc holds is farther from its centre (m).
  static float farthest(const MeshConfig& config);

  /// False where the surfel has no finite position, normal or radius.
  bool make(std::size_t i, Disc& disc) const;

  /// The cells of which the disc reaches any corner. False where they are too far away to count.
  bool cells(const Disc& disc, CellRange& range) const;

 private:
  const SurfelArrays& surfels_;
  float cell_m_, bridge_m_, depth_m_;
};

/// Which surfels reach which block of the lattice.
struct DiscBlocks {
  BlockLattice lattice;
  std::vector<std::size_t> first;      ///< of block i in `surfels`; one more at the end
  std::vector<std::uint32_t> surfels;  ///< ascending in each block
};

/// Throws InputError where a mesh of these surfels would take more than config.memory_limit_mb, or
/// where there are none.
DiscBlocks discBlocks(const SurfelArrays& surfels, const MeshConfig& config);

/// Calls visit(place in the block, disc, where the point lies to it) for the points of block i that
/// each of its discs reaches, disc by disc. `pointAt(place, cell, point)`: the point of a cell,
/// false where it has none.
template <typename PointAt, typename Visit>
void forEachPointOf(const DiscMaker& maker, const DiscBlocks& blocks, std::size_t i,
                    const PointAt& pointAt, const Visit& visit) {
  const Eigen::Vector3i first = blocks.lattice.firstCorner(i);
  Disc disc;
  CellRange cells;
  Disc::Place where;
  Eigen::Vector3f point;
  for (std::size_t k = blocks.first[i]; k < blocks.first[i + 1]; ++k) {
    if (!maker.make(blocks.surfels[k], disc) || !maker.cells(disc, cells)) continue;
    const Eigen::Vector3i low = (cells.low - first).cwiseMax(0);
    const Eigen::Vector3i high = (cells.high - first).cwiseMin(BlockLattice::kSide - 1);
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int x = low.x(); x <= high.x(); ++x) {
          const std::size_t place = BlockLattice::placeOf(x, y, z);
          if (!pointAt(place, first + Eigen::Vector3i(x, y, z), point)) continue;
          if (disc.holds(point, where)) visit(place, disc, where);
        }
      }
    }
  }
}

}  // namespace pf
