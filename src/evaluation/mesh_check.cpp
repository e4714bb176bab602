// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/mesh_check.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pf {
namespace {

using Eigen::Vector3f;

constexpr float kSpacing_m = 0.01F;

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

/// How many of the points have one of these discs within kCovered_m.
std::size_t countCovered(const std::vector<Vector3f>& points, const SurfaceSamples& discs) {
  const std::vector<float> distances = distancesToSurface(points, discs);
  return static_cast<std::size_t>(
      std::count_if(distances.begin(), distances.end(), [](float d) { return d <= kCovered_m; }));
}

/// The centres of surfels, as discs without extent.
SurfaceSamples centresOf(const SurfelArrays& surfels) {
  SurfaceSamples centres;
  centres.radius_m = 0;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    centres.positions.emplace_back(surfels.x[i], surfels.y[i], surfels.z[i]);
    centres.normals.emplace_back(surfels.nx[i], surfels.ny[i], surfels.nz[i]);
  }
  return centres;
}

/// Triangles whose corners and middle are all far from the centres of all surfels.
std::size_t countInvented(const TriangleMesh& mesh, const SurfelArrays& surfels) {
  const SurfaceSamples centres = centresOf(surfels);
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

double shareCovered(const std::vector<Vector3f>& points, const SurfelArrays& surfels,
                    const Eigen::Isometry3d& T_truth_map) {
  if (points.empty()) return 0;
  std::vector<Vector3f> in_map = points;
  const Eigen::Isometry3f T_map_truth = T_truth_map.inverse().cast<float>();
  for (Vector3f& p : in_map) p = T_map_truth * p;
  return static_cast<double>(countCovered(in_map, centresOf(surfels))) /
         static_cast<double>(points.size());
}

MeshScore checkMesh(const TriangleMesh& mesh, const SurfelArrays& surfels,
                    const Eigen::Isometry3d& T_truth_map, const SurfaceSamples& truth,
                    const std::vector<Vector3f>& seen) {
  MeshScore score;
  score.triangles = mesh.triangles.size();
  score.seen = seen.size();
  if (mesh.triangles.empty()) return score;
  score.invented = countInvented(mesh, surfels);
  MeshSamples samples = sampleMesh(mesh);
  const Eigen::Isometry3f T = T_truth_map.cast<float>();
  for (Vector3f& p : samples.positions) p = T * p;
  for (Vector3f& n : samples.normals) n = T.linear() * n;
  score.area_m2 = std::accumulate(samples.area_m2.begin(), samples.area_m2.end(), 0.0);
  const std::vector<float> distances = distancesToSurface(samples.positions, truth);
  score.median_m = quantile(distances, samples.area_m2, 0.5);
  score.p95_m = quantile(distances, samples.area_m2, 0.95);
  score.covered = countCovered(
      seen, {std::move(samples.positions), std::move(samples.normals), 0.5F * kSpacing_m});
  return score;
}

}  // namespace pf
