// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "posefusion/core/camera.hpp"
#include "posefusion/map/surfels.hpp"
#include "posefusion/map/visibility.hpp"

namespace pf {

/// Surfels nearer to the camera's plane (m) are not looked at.
constexpr float kNear_m = 0.1F;

/// A pose and a camera in plain floats, for the kernel.
struct Projection {
  Projection(const PinholeCamera& camera, const Eigen::Isometry3d& T_map_camera);

  float r[9], t[3];  ///< camera from map, row by row
  float centre[3];   ///< of the camera, in the map
  float fx, fy, cx, cy;
  float width, height;  ///< pixels
};

/// The surfels of one range as the camera sees them.
struct ProjectedRange {
  float x[kRangeSurfels], y[kRangeSurfels], z[kRangeSurfels];  ///< camera frame, m
  float u[kRangeSurfels], v[kRangeSurfels];                    ///< pixel of the centre
  float reach[kRangeSurfels];                                  ///< radius in pixels
  float facing[kRangeSurfels];  ///< normal . (surfel - camera), m: above 0 it is seen from behind
  std::int32_t
      inside[kRangeSurfels];  ///< 0: its disc, grown by half a pixel, is not in the picture
};

/// Fills the first (range.end - range.begin) entries.
void project(const SurfelArrays& surfels, const SurfelRange& range, const Projection& projection,
             ProjectedRange& out);

}  // namespace pf
