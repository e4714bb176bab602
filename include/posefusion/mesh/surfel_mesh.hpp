// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/map/surfels.hpp"
#include "posefusion/mesh/config.hpp"
#include "posefusion/mesh/triangle_mesh.hpp"

namespace pf {

/// The surface that surfels lie on: the zero level of the distance to their planes, on a lattice
/// around the origin of their frame, with colours and normals of the surfels around each corner. It
/// has two sides where they have, and ends where they end: no corner is farther than 1.4
/// times MeshConfig::bridge_m from the centre of a surfel that faces the same way, so unobserved
/// space gets no surface. Surfels without a finite position, normal or radius are left out; a
/// vertex is grey where no surfel around it has a colour. The same bytes for any number of threads.
/// Throws InputError where it would take more memory than the limit, before it starts, and where
/// the surfels are too few for a single triangle.
TriangleMesh surfelMesh(const SurfelArrays& surfels, const MeshConfig& config);

/// The same; without a triangle where the surfels are too few.
TriangleMesh surfelMeshIfAny(const SurfelArrays& surfels, const MeshConfig& config);

}  // namespace pf
