// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <set>
#include <vector>

#include "posefusion/map/surfel_map.hpp"
#include "posefusion/mesh/config.hpp"
#include "posefusion/mesh/triangle_mesh.hpp"

namespace pf {

/// The mesh of the stable surfels of a map that grows (first fragment), in cubes, of which only
/// those are made anew around which surfels have changed. Together the cubes are the mesh of
/// surfelMesh(): each triangle is in that in which its centre lies. Not thread safe.
class MeshPieces {
 public:
  /// Number of a cube along each axis.
  using Key = std::array<int, 3>;
  struct Piece {
    Key key{};
    TriangleMesh mesh;  ///< map frame; no triangles: there is nothing any more
  };

  /// `side_m`: of a cube. Throws InputError naming the first value that cannot be.
  MeshPieces(const MeshConfig& config, float side_m);

  /// The pieces that have changed since the call before; `map` grows from the map of that call, or
  /// is another one. Where `stops` says so no further piece is made; the next call does. Throws
  /// InputError where a piece would take more memory than the limit.
  std::vector<Piece> update(const SurfelMap& map, const std::function<bool()>& stops = {});

  /// The next call gives all.
  void forget();

 private:
  Eigen::AlignedBox3f boxOf(const Key& key) const;
  void mark(const SurfelBlock& block);
  void markChanges(const SharedBlocks& blocks);
  SurfelArrays surfelsAround(const SurfelMap& map, const Key& key) const;
  TriangleMesh make(const SurfelMap& map, const Key& key) const;

  MeshConfig config_;
  float side_m_;
  float reach_m_;        // a surfel has no influence on triangles whose centre is farther
  SharedBlocks before_;  // of the map of the call before
  std::set<Key> doubtful_, shown_;
};

}  // namespace pf
