// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/map/surfels.hpp"
#include "posefusion/mesh/config.hpp"
#include "posefusion/mesh/triangle_mesh.hpp"

namespace pf {

/// Meshes of the Point Cloud Library from the same surfels, for comparison: each corner has normal
/// and colour of the nearest surfel, and triangles away from all surfels (1.4 bridges from their
/// centres) are left out. Throw InputError where nothing is left, or where this was built without
/// PCL.

/// M. Kazhdan et al., "Poisson surface reconstruction", 2006; an octree as deep as the cells ask.
TriangleMesh poissonMesh(const SurfelArrays& surfels, const MeshConfig& config);

/// Z. Marton et al., "On fast surface reconstruction methods for large and noisy point clouds",
/// 2009: the surfels themselves, joined.
TriangleMesh greedyMesh(const SurfelArrays& surfels, const MeshConfig& config);

}  // namespace pf
