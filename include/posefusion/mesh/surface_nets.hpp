// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <vector>

#include "posefusion/mesh/block_lattice.hpp"
#include "posefusion/mesh/triangle_mesh.hpp"

namespace pf {

/// Signed distances (m, above 0 outside) at the corners of a lattice; NaN where nothing is known.
struct DistanceField {
  explicit DistanceField(BlockLattice of);

  BlockLattice lattice;
  std::vector<float> values;  ///< kCorners for each block
};

/// The zero level of a field, and which cell each corner of a triangle is of.
struct SurfaceNet {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  static constexpr std::uint16_t kNoPlace = 0xffff;

  std::vector<Eigen::Vector3f> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> first;  ///< vertex of each block
  std::vector<std::uint16_t> place;  ///< of each cell's vertex after that; kNoPlace: it has none

  /// The vertex of a cell of block i, or kNone.
  std::uint32_t vertex(std::size_t i, std::size_t cell) const {
    const std::uint16_t after = place[i * BlockLattice::kCorners + cell];
    return after == kNoPlace ? kNone : first[i] + after;
  }
};

/// Naive surface nets (S. Gibson, "Constrained elastic surface nets", 1998): a vertex in each cell
/// of eight known corners that the surface crosses, at the mean of where it crosses the edges; a
/// quad across each edge that is crossed. What is not known has no surface. The order of vertices
/// and triangles depends on the field alone.
SurfaceNet surfaceNet(const DistanceField& field);

/// The zero level of a distance within a box, on cells of `cell_m`, with its gradient as normals.
TriangleMesh polygonise(const std::function<float(const Eigen::Vector3f&)>& distance,
                        const Eigen::AlignedBox3f& box, float cell_m);

}  // namespace pf
