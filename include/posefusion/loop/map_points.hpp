// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// A thinned copy of the map to search places in: one stable surfel per voxel and facing. Immutable
/// once made, so that a search may run beside fusion.
struct MapPoints {
  std::vector<float> x, y, z;     ///< m, map frame
  std::vector<float> nx, ny, nz;  ///< unit normal, map frame
  std::vector<float> intensity;   ///< 0..255
  float voxel_m = 0;              ///< side of a voxel

  std::size_t size() const { return x.size(); }
};

/// Of each voxel and facing (the axis nearest to the normal) the stable surfel with the most
/// support. The order depends on the map alone.
MapPoints thinnedPoints(const SurfelMap& map, double voxel_m = 0.04);

/// Unit normals (components may be 0: no normal).
struct Normals {
  const float *x, *y, *z;
  std::size_t count;
};

/// The direction that floors and table tops face: the one with the most normals within 6 degrees of
/// it, of those within `max_angle_rad` of `guess`; their mean. Nothing when fewer than `least` of
/// the normals agree. In the frame of the normals.
std::optional<Eigen::Vector3d> levelDirection(const Normals& normals, const Eigen::Vector3d& guess,
                                              double max_angle_rad, double least = 0.05);

}  // namespace pf
