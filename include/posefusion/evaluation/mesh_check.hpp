// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "posefusion/evaluation/surface_check.hpp"
#include "posefusion/mesh/triangle_mesh.hpp"

namespace pf {

/// Points on a mesh that are at most about 1 cm apart, with the area (m^2) that each represents.
struct MeshSamples {
  std::vector<Eigen::Vector3f> positions, normals;
  std::vector<float> area_m2;
};

MeshSamples sampleMesh(const TriangleMesh& mesh);

/// A triangle farther than this from the centre of every surfel is invented.
constexpr float kInvented_m = 0.05F;
/// True surface is covered where its normal meets the mesh so near, facing the same way: the map
/// may be off by that, and any hole is one. Or where some of the mesh is really near: rims of the
/// truth lie beside those of the map. (m)
constexpr float kCovered_m = 0.10F, kCoveredBeside_m = 0.02F;

/// How good a mesh is.
struct MeshScore {
  std::size_t triangles = 0, invented = 0;
  double area_m2 = 0;
  double median_m = 0, p95_m = 0;     ///< of its area to the true surface
  std::size_t seen = 0, covered = 0;  ///< samples of the true surface

  double coverage() const;  ///< covered / seen, 0 of none
};

/// A mesh and the surfels that it was made of, both in the frame of the map, against the truth.
/// `seen`: of the true surface, what a mesh should have (SeenSurface).
MeshScore checkMesh(const TriangleMesh& mesh, const SurfelArrays& surfels,
                    const Eigen::Isometry3d& T_truth_map, const SurfaceSamples& truth,
                    const SurfaceSamples& seen);

/// The share of these samples that the discs of the surfels alone cover, for comparison; 0 of none.
double shareCovered(const SurfaceSamples& seen, const SurfelArrays& surfels,
                    const Eigen::Isometry3d& T_truth_map);

}  // namespace pf
