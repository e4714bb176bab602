// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/mesh/surfel_mesh.hpp"

#include <cmath>
#include <string>

#include "disc_distance.hpp"
#include "posefusion/core/error.hpp"
#include "vertex_paint.hpp"

namespace pf {
namespace {

constexpr double kLeastCell_m = 1e-4, kMostCell_m = 1.0;

/// The triangles whose corners are all seen.
std::vector<char> seenTriangles(const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                const std::vector<char>& seen) {
  std::vector<char> keep(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& t = triangles[i];
    keep[i] = seen[t[0]] != 0 && seen[t[1]] != 0 && seen[t[2]] != 0 ? 1 : 0;
  }
  return keep;
}

}  // namespace

void validate(const MeshConfig& config) {
  require(config.cell_m >= kLeastCell_m && config.cell_m <= kMostCell_m,
          "mesh: cell:", config.cell_m, "0.0001 to 1 m");
  require(config.bridge_m >= 0 && config.bridge_m <= 1, "mesh: bridge:", config.bridge_m,
          "0 to 1 m");
  require(config.least_surfels >= 1, "mesh: least surfels:", config.least_surfels, "at least 1");
  require(config.memory_limit_mb > 0, "mesh: memory limit:", config.memory_limit_mb,
          "more than 0 MB");
}

TriangleMesh surfelMeshIfAny(const SurfelArrays& surfels, const MeshConfig& config) {
  validate(config);
  TriangleMesh mesh;
  if (surfels.size() == 0) return mesh;
  std::vector<char> keep;
  {
    const DiscBlocks blocks = discBlocks(surfels, config);
    SurfaceNet net = surfaceNet(discDistance(surfels, blocks, config));
    PaintedVertices painted = paint(surfels, blocks, config, net);
    keep = seenTriangles(net.triangles, painted.seen);
    mesh.positions = std::move(net.positions);
    mesh.triangles = std::move(net.triangles);
    mesh.normals = std::move(painted.normals);
    mesh.colors = std::move(painted.colors);
  }
  return onlyKept(mesh, keep);
}

TriangleMesh surfelMesh(const SurfelArrays& surfels, const MeshConfig& config) {
  TriangleMesh mesh = surfelMeshIfAny(surfels, config);
  if (!mesh.triangles.empty()) return mesh;
  throw InputError("mesh: " + std::to_string(surfels.size()) +
                   " stable surfels are too few for a surface, expected at least " +
                   std::to_string(config.least_surfels) + " beside each other");
}

}  // namespace pf
