// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

namespace pf {

/// A pinhole camera with an optional plumb_bob distortion, optical frame (z forward, x right,
/// y down), pixel centres at integer coordinates.
struct PinholeCamera {
  int width = 0;
  int height = 0;
  double fx = 0.0;  ///< pixels
  double fy = 0.0;  ///< pixels
  double cx = 0.0;  ///< pixels
  double cy = 0.0;  ///< pixels
  /// plumb_bob k1 k2 p1 p2 k3; all zero when the images are rectified.
  std::array<double, 5> distortion{};

  bool isDistorted() const;

  /// The camera of an image shrunk by `factor` (2 = half the width), whose pixel (0, 0) averages
  /// the full image's pixels (0 .. factor - 1).
  PinholeCamera shrunk(int factor) const;

  /// Pixel of a point (camera frame, metres, z > 0). Ignores distortion.
  Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    return {fx * point.x() / point.z() + cx, fy * point.y() / point.z() + cy};
  }

  /// Point (camera frame, metres) seen at pixel (u, v) with depth z. Ignores distortion.
  Eigen::Vector3d unproject(double u, double v, double z_m) const {
    return {(u - cx) / fx * z_m, (v - cy) / fy * z_m, z_m};
  }

  bool operator==(const PinholeCamera& other) const;
  bool operator!=(const PinholeCamera& other) const { return !(*this == other); }
};

/// Throws InputError naming the first field that no real camera can have.
void validate(const PinholeCamera& camera);

}  // namespace pf
