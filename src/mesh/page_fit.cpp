// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/mesh/page_fit.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion/map/thinned.hpp"
#include "posefusion/mesh/surfel_mesh.hpp"

namespace pf {
namespace {

constexpr double kCoarsest_m = 1.0;
constexpr double kFirstVoxel_m = 0.01;
constexpr double kSpare = 1.03;  // what is cut at the borders of chunks is there twice

PageGeometry geometryOf(std::vector<PageChunk> chunks, double step_m) {
  PageGeometry geometry;
  geometry.chunks = std::move(chunks);
  geometry.step_m = step_m;
  for (const PageChunk& chunk : geometry.chunks) {
    geometry.vertices += chunk.vertices.size();
    geometry.triangles += chunk.indices.size() / 3;
  }
  return geometry;
}

/// A surface of cells: half the bytes take cells that are longer by the root of two.
double longer(double step_m, std::size_t bytes, std::size_t most_bytes) {
  return kSpare * step_m * std::sqrt(static_cast<double>(bytes) / static_cast<double>(most_bytes));
}

void requireRoom(double step_m, std::size_t most_bytes) {
  if (step_m <= kCoarsest_m) return;
  throw InputError("page: has room for " + std::to_string(most_bytes) +
                   " bytes of the map, expected enough for cells of 1 m");
}

}  // namespace

std::size_t PageGeometry::bytes() const {
  std::size_t sum = 0;
  for (const PageChunk& chunk : chunks) sum += chunk.bytes();
  return sum;
}

PageGeometry pageMesh(const SurfelArrays& surfels, MeshConfig config, std::size_t most_bytes) {
  while (true) {
    PageGeometry geometry = geometryOf(pageChunks(surfelMesh(surfels, config)), config.cell_m);
    if (geometry.bytes() <= most_bytes) return geometry;
    const double cell_m = longer(config.cell_m, geometry.bytes(), most_bytes);
    requireRoom(cell_m, most_bytes);
    config.cell_m = cell_m;
    // Else vertices in the middle of large cells would be left out, far from any surfel.
    config.bridge_m = std::max(config.bridge_m, cell_m);
  }
}

PageGeometry pageSurfels(const SurfelArrays& surfels, std::size_t most_bytes) {
  PageGeometry geometry = geometryOf(pageChunks(surfels), 0);
  if (geometry.vertices == 0) {
    throw InputError("page: none of " + std::to_string(surfels.size()) +
                     " stable surfels can be shown, expected at least one");
  }
  for (double voxel_m = kFirstVoxel_m; geometry.bytes() > most_bytes;) {
    geometry = geometryOf(pageChunks(thinned(surfels, static_cast<float>(voxel_m))), voxel_m);
    voxel_m = longer(voxel_m, geometry.bytes(), most_bytes);
    requireRoom(voxel_m, most_bytes);
  }
  return geometry;
}

}  // namespace pf
