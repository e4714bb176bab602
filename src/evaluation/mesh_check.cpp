// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/mesh_check.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "posefusion/core/normal_line.hpp"
#include "posefusion/core/parallel.hpp"
#include "posefusion/core/point_grid.hpp"

namespace pf {
namespace {

using Eigen::Vector3f;

constexpr float kSpacing_m = 0.01F;
constexpr float kFacingOfTriangle = 0.3F;  // 73 degrees
constexpr std::size_t kCellsAtOnce = 1024;

/// The value that this share of the area stays below.
double quantile(const std::vector<float>& values, const std::vector<float>& areas, double share) {
  std::vector<std::uint32_t> order(values.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return values[a] < values[b]; });
  const double whole = std::accumulate(areas.begin(), areas.end(), 0.0);
  double sum = 0;
  for (const std::uint32_t i : order) {
    sum += areas[i];
    if (sum >= share * whole) return values[i];
  }
  return 0;
}

/// How many of the samples have one of these discs where they should.
std::size_t countCovered(const SurfaceSamples& seen, const SurfaceSamples& discs,
                         const std::vector<float>& radii) {
  const PointGrid grid(discs.positions);
  const float largest = *std::max_element(radii.begin(), radii.end());
  std::vector<char> covered(seen.positions.size(), 0);
  parallelFor(covered.size(), kCellsAtOnce, [&](std::size_t begin, std::size_t end) {
    float at = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const NormalLine line{seen.positions[i], seen.normals[i]};
      grid.visit(line.box(kCovered_m, largest + kCoveredBeside_m), [&](std::size_t k) {
        if (covered[i] != 0) return;
        const bool met = line.meets(grid[k], discs.normals[k], radii[k], kFacingOfTriangle, at);
        const bool beside = (grid[k] - line.from).norm() <= kCoveredBeside_m + radii[k];
        covered[i] = beside || (met && std::abs(at) <= kCovered_m) ? 1 : 0;
      });
    }
  });
  return static_cast<std::size_t>(std::count(covered.begin(), covered.end(), 1));
}

/// Triangles whose corners and middle are all far from the centres of all surfels.
std::size_t countInvented(const TriangleMesh& mesh, const SurfelArrays& surfels) {
  const SurfaceSamples centres = centresOf(surfels, Eigen::Isometry3d::Identity());
  std::vector<Vector3f> middles;
  for (const auto& t : mesh.triangles) {
    middles.push_back((mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3);
  }
  const std::vector<float> corner_m = distancesToSurface(mesh.positions, centres);
  const std::vector<float> middle_m = distancesToSurface(middles, centres);
  std::size_t invented = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    float nearest = middle_m[i];
    for (const std::uint32_t corner : mesh.triangles[i])
      nearest = std::min(nearest, corner_m[corner]);
    invented += nearest > kInvented_m ? 1 : 0;
  }
  return invented;
}

}  // namespace

MeshSamples sampleMesh(const TriangleMesh& mesh) {
  MeshSamples samples;
  for (const auto& t : mesh.triangles) {
    const Vector3f a = mesh.positions[t[0]];
    const Vector3f ab = mesh.positions[t[1]] - a, ac = mesh.positions[t[2]] - a;
    const Vector3f normal = ab.cross(ac);
    const float longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
    const int parts = std::max(1, static_cast<int>(std::ceil(longest / kSpacing_m)));
    const auto n = static_cast<float>(parts);
    // The middles of the parts^2 triangles that it is cut into.
    for (int i = 0; i < parts; ++i) {
      for (int k = 0; k < 2 * (parts - i) - 1; ++k) {
        const float along = static_cast<float>(k / 2) + (k % 2 == 0 ? 1.0F : 2.0F) / 3.0F;
        const float across = static_cast<float>(i) + (k % 2 == 0 ? 1.0F : 2.0F) / 3.0F;
        samples.positions.push_back(a + along / n * ab + across / n * ac);
        samples.normals.push_back(normal.normalized());
        samples.area_m2.push_back(0.5F * normal.norm() / (n * n));
      }
    }
  }
  return samples;
}

double MeshScore::coverage() const {
  return seen > 0 ? static_cast<double>(covered) / static_cast<double>(seen) : 0.0;
}

double shareCovered(const SurfaceSamples& seen, const SurfelArrays& surfels,
                    const Eigen::Isometry3d& T_truth_map) {
  if (seen.positions.empty() || surfels.size() == 0) return 0;
  const SurfaceSamples discs = centresOf(surfels, T_truth_map);
  return static_cast<double>(countCovered(seen, discs, surfels.radius)) /
         static_cast<double>(seen.positions.size());
}

MeshScore checkMesh(const TriangleMesh& mesh, const SurfelArrays& surfels,
                    const Eigen::Isometry3d& T_truth_map, const SurfaceSamples& truth,
                    const SurfaceSamples& seen) {
  MeshScore score;
  score.triangles = mesh.triangles.size();
  score.seen = seen.positions.size();
  if (mesh.triangles.empty()) return score;
  score.invented = countInvented(mesh, surfels);
  MeshSamples samples = sampleMesh(mesh);
  score.area_m2 = std::accumulate(samples.area_m2.begin(), samples.area_m2.end(), 0.0);
  SurfaceSamples discs{std::move(samples.positions), std::move(samples.normals), kSpacing_m};
  move(T_truth_map, discs);
  const std::vector<float> distances = distancesToSurface(discs.positions, truth);
  score.median_m = quantile(distances, samples.area_m2, 0.5);
  score.p95_m = quantile(distances, samples.area_m2, 0.95);
  score.covered = countCovered(seen, discs, std::vector<float>(discs.positions.size(), kSpacing_m));
  return score;
}

}  // namespace pf
