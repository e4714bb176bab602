// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/surface_check.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/error.hpp"
#include "posefusion/core/normal_line.hpp"
#include "posefusion/core/parallel.hpp"
#include "posefusion/core/point_grid.hpp"

namespace pf {
namespace {

constexpr float kFirstSearch_m = 0.05F;
constexpr std::size_t kSurfelsAtOnce = 4096;
// Surfels of one layer, and the truth that they belong to, lean against each other less than this.
constexpr float kSameFacing = 0.8F;      // 37 degrees
constexpr float kFacingOfTruth = 0.5F;   // 60 degrees: a surfel's normal is the noisier one
constexpr float kTruthBeyond_m = 0.10F;  // true surface is looked for so far beyond the layers

float distanceToDisc(const Eigen::Vector3f& point, const Eigen::Vector3f& center,
                     const Eigen::Vector3f& normal, float radius) {
  const Eigen::Vector3f step = point - center;
  const float above = normal.dot(step);
  const float beside = std::max(0.0F, (step - above * normal).norm() - radius);
  return std::hypot(above, beside);
}

Eigen::AlignedBox3f boxAround(const Eigen::Vector3f& point, float reach) {
  return {point - Eigen::Vector3f::Constant(reach), point + Eigen::Vector3f::Constant(reach)};
}

/// The one of these places along a line that is nearest.
float nearestTo(float at, const std::vector<float>& places) {
  return *std::min_element(places.begin(), places.end(),
                           [at](float a, float b) { return std::abs(a - at) < std::abs(b - at); });
}

/// Whether the truth has one surface for what lies at 0 and at `at`.
bool isOneSurface(float at, const std::vector<float>& truth) {
  return truth.empty() || std::abs(nearestTo(0, truth) - nearestTo(at, truth)) < kLeastDoubled_m;
}

}  // namespace

void move(const Eigen::Isometry3d& T_to_from, SurfaceSamples& samples) {
  const Eigen::Isometry3f T = T_to_from.cast<float>();
  for (Eigen::Vector3f& p : samples.positions) p = T * p;
  for (Eigen::Vector3f& n : samples.normals) n = T.linear() * n;
}

SurfaceSamples centresOf(const SurfelArrays& surfels, const Eigen::Isometry3d& T_to_map) {
  SurfaceSamples centres;
  centres.radius_m = 0;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    centres.positions.emplace_back(surfels.x[i], surfels.y[i], surfels.z[i]);
    centres.normals.emplace_back(surfels.nx[i], surfels.ny[i], surfels.nz[i]);
  }
  move(T_to_map, centres);
  return centres;
}

std::vector<float> distancesToSurface(const std::vector<Eigen::Vector3f>& points,
                                      const SurfaceSamples& truth) {
  const PointGrid grid(truth.positions);
  std::vector<float> distances(points.size(), kFarFromSurface_m);
  parallelFor(points.size(), kSurfelsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      float& least = distances[i];
      // The farther it is, the wider the search.
      for (float reach = kFirstSearch_m; least > reach && reach < 2 * kFarFromSurface_m;
           reach *= 2) {
        grid.visit(boxAround(points[i], reach + truth.radius_m), [&](std::size_t k) {
          least =
              std::min(least, distanceToDisc(points[i], grid[k], truth.normals[k], truth.radius_m));
        });
      }
    }
  });
  return distances;
}

std::vector<float> distancesToSurface(const SurfelArrays& surfels,
                                      const Eigen::Isometry3d& T_truth_map,
                                      const SurfaceSamples& truth) {
  return distancesToSurface(centresOf(surfels, T_truth_map).positions, truth);
}

std::vector<char> surfelsInTwoLayers(const SurfelArrays& surfels,
                                     const Eigen::Isometry3d& T_truth_map,
                                     const SurfaceSamples& truth) {
  const SurfaceSamples map = centresOf(surfels, T_truth_map);
  float largest_radius = 0;
  for (const float radius : surfels.radius) largest_radius = std::max(largest_radius, radius);
  const PointGrid surfel_grid(map.positions), truth_grid(truth.positions);
  std::vector<char> doubled(surfels.size(), 0);
  parallelFor(surfels.size(), kSurfelsAtOnce, [&](std::size_t begin, std::size_t end) {
    std::vector<float> layers, truths;
    for (std::size_t i = begin; i < end; ++i) {
      const NormalLine line{map.positions[i], map.normals[i]};
      float at = 0;
      layers.clear();
      surfel_grid.visit(line.box(kMostDoubled_m, largest_radius), [&](std::size_t k) {
        const float radius = surfels.radius[k];
        if (!line.meets(map.positions[k], map.normals[k], radius, kSameFacing, at)) return;
        const float apart = std::abs(at);
        if (apart >= kLeastDoubled_m && apart <= kMostDoubled_m) layers.push_back(at);
      });
      if (layers.empty()) continue;
      truths.clear();
      truth_grid.visit(line.box(kMostDoubled_m + kTruthBeyond_m, truth.radius_m),
                       [&](std::size_t k) {
                         const bool met = line.meets(truth.positions[k], truth.normals[k],
                                                     truth.radius_m, kFacingOfTruth, at);
                         if (met) truths.push_back(at);
                       });
      doubled[i] = std::any_of(layers.begin(), layers.end(),
                               [&](float layer) { return isOneSurface(layer, truths); });
    }
  });
  return doubled;
}

double SurfaceScore::layerShare() const {
  return surfels > 0 ? static_cast<double>(in_two_layers) / static_cast<double>(surfels) : 0.0;
}

SurfaceScore checkSurface(const SurfelArrays& surfels, const Eigen::Isometry3d& T_truth_map,
                          const SurfaceSamples& truth) {
  if (truth.positions.size() != truth.normals.size()) {
    throw InputError("true surface: " + std::to_string(truth.positions.size()) + " points and " +
                     std::to_string(truth.normals.size()) + " normals, expected as many");
  }
  SurfaceScore score;
  score.surfels = surfels.size();
  if (score.surfels == 0) return score;
  std::vector<float> distances = distancesToSurface(surfels, T_truth_map, truth);
  std::sort(distances.begin(), distances.end());
  score.median_m = distances[distances.size() / 2];
  score.p95_m = distances[std::min(distances.size() - 1, distances.size() * 95 / 100)];
  for (const char doubled : surfelsInTwoLayers(surfels, T_truth_map, truth)) {
    score.in_two_layers += doubled != 0 ? 1 : 0;
  }
  return score;
}

}  // namespace pf
