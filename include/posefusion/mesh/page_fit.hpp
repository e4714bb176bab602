// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posefusion/mesh/config.hpp"
#include "posefusion/mesh/page_chunks.hpp"

namespace pf {

/// What a page shows of a map, as fine as there is room for.
struct PageGeometry {
  std::vector<PageChunk> chunks;
  std::size_t vertices = 0, triangles = 0;
  double step_m = 0;  ///< side of the cells that it was made with; 0: all surfels as they are

  std::size_t bytes() const;
};

/// The mesh of surfelMesh(), with larger cells than `config` asks for where it would take more than
/// `most_bytes`. What gaps it closes grows with them. Throws InputError as that does, and where
/// there is no room for cells of a metre.
PageGeometry pageMesh(const SurfelArrays& surfels, MeshConfig config, std::size_t most_bytes);

/// The surfels, or one for each of the smallest cubes that `most_bytes` have room for. Throws
/// InputError where there is none to be shown.
PageGeometry pageSurfels(const SurfelArrays& surfels, std::size_t most_bytes);

}  // namespace pf
