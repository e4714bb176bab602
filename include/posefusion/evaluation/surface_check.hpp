// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "posefusion/map/surfels.hpp"

namespace pf {

/// A true surface, sampled: discs with these centres (m) and unit normals that cover it.
struct SurfaceSamples {
  std::vector<Eigen::Vector3f> positions, normals;
  float radius_m = 0.03F;  ///< of all discs
};

/// Brings samples into another frame.
void move(const Eigen::Isometry3d& T_to_from, SurfaceSamples& samples);

/// The centres of surfels in another frame, as discs without extent.
SurfaceSamples centresOf(const SurfelArrays& surfels, const Eigen::Isometry3d& T_to_map);

/// A surfel farther from all true surface than this counts as so far.
constexpr float kFarFromSurface_m = 0.5F;

/// Distance (m) of each point, in the frame of the samples, to the nearest of the discs.
std::vector<float> distancesToSurface(const std::vector<Eigen::Vector3f>& points,
                                      const SurfaceSamples& truth);

/// Distance (m) of each surfel's centre to the nearest of the discs. `T_truth_map` brings the map
/// into the frame of the samples.
std::vector<float> distancesToSurface(const SurfelArrays& surfels,
                                      const Eigen::Isometry3d& T_truth_map,
                                      const SurfaceSamples& truth);

/// Two layers of one surface are so far apart (m).
constexpr float kLeastDoubled_m = 0.02F, kMostDoubled_m = 0.15F;

/// Which surfels (1, else 0) lie in one of two layers where the truth has one surface: the line
/// along the normal meets the disc of another surfel that faces the same way, 2 to 15 cm before or
/// behind; and the true surfaces that face that way and are nearest to the two along the line are
/// one, or there is none.
std::vector<char> surfelsInTwoLayers(const SurfelArrays& surfels,
                                     const Eigen::Isometry3d& T_truth_map,
                                     const SurfaceSamples& truth);

/// How near a map is to the true surface.
struct SurfaceScore {
  std::size_t surfels = 0;
  double median_m = 0, p95_m = 0;  ///< distance; 0 of no surfels
  std::size_t in_two_layers = 0;

  /// in_two_layers / surfels, 0 of none.
  double layerShare() const;
};

SurfaceScore checkSurface(const SurfelArrays& surfels, const Eigen::Isometry3d& T_truth_map,
                          const SurfaceSamples& truth);

}  // namespace pf
