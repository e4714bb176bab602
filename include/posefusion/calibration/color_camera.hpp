// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>

#include "posefusion/core/camera.hpp"

namespace pf {

/// The camera of colour images that are not registered to depth: beside the depth camera, parallel
/// to it. Pixels are those of images without lens distortion.
struct ColorCamera {
  double fx = 0.0;             ///< pixels
  double fy = 0.0;             ///< pixels
  double cx = 0.0;             ///< pixels
  double cy = 0.0;             ///< pixels
  double depth_right_m = 0.0;  ///< the depth camera is so far right of it

  /// Where it sees what the depth camera sees at pixel (u, v) and at 1 / `inverse_depth_per_m`.
  Eigen::Vector2d pixel(const PinholeCamera& depth, double u, double v,
                        double inverse_depth_per_m) const {
    return {fx * ((u - depth.cx) / depth.fx + depth_right_m * inverse_depth_per_m) + cx,
            fy * (v - depth.cy) / depth.fy + cy};
  }
};

/// Of images that are registered to depth.
inline ColorCamera registeredTo(const PinholeCamera& depth) {
  return {depth.fx, depth.fy, depth.cx, depth.cy, 0.0};
}

/// "fx 525.0 fy 525.0 cx 319.5 cy 239.5, the depth camera 27.0 mm right of it".
std::string describe(const ColorCamera& camera);

}  // namespace pf
