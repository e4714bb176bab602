// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// A thinned copy of a fragment of the map to search places in: one stable surfel per voxel and
/// facing. Immutable once made, so that a search may run beside fusion.
struct MapPoints {
  std::vector<float> x, y, z;     ///< m, map frame
  std::vector<float> nx, ny, nz;  ///< unit normal, map frame
  std::vector<float> intensity;   ///< 0..255
  float voxel_m = 0;              ///< side of a voxel

  std::size_t size() const { return x.size(); }
};

/// Of each voxel and facing (the axis nearest to the normal) the stable surfel with the most
/// support. The order depends on the map alone.
MapPoints thinnedPoints(const SurfelMap& map, int fragment = kFirstFragment, double voxel_m = 0.06);

/// Of each voxel of this side and facing the mean, its normal of unit length.
MapPoints coarser(const MapPoints& points, double voxel_m);

/// The same points at several densities, the densest first, each with voxels twice as large: what
/// is far away needs fewer.
using PointPyramid = std::vector<MapPoints>;

PointPyramid pointPyramid(MapPoints densest);

/// Points with unit normals, of which `count`.
struct OrientedPoints {
  const float *x, *y, *z;
  const float *nx, *ny, *nz;
  std::size_t count;
};

OrientedPoints orientedPoints(const MapPoints& points);

/// The level surfaces among some points.
struct Levels {
  Eigen::Vector3d up;   ///< against gravity, unit length
  double lowest_m = 0;  ///< along `up`: of the lowest large level, a floor among tables
};

/// The direction that floors and table tops face: the one with the most normals within 6 degrees of
/// it, of those within `max_angle_rad` of `guess`; then of the plane through the largest level
/// (normals of surfaces seen at a low angle lean). Nothing when fewer than 5 % of the points face
/// it. In the frame of the points.
std::optional<Levels> findLevels(const OrientedPoints& points, const Eigen::Vector3d& guess,
                                 double max_angle_rad);

}  // namespace pf
