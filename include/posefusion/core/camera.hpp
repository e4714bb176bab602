// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>

namespace pf {

/// How a lens bends rays, with OpenCV's formulas.
enum class LensModel {
  kPolynomial,   ///< radial and tangential: plumb_bob, and rational_polynomial with k4 k5 k6
  kEquidistant,  ///< fisheye: the angle to the axis, not its tangent (Kannala and Brandt 2006)
};

/// By the names that ROS, OpenCV and ORB-SLAM give it: plumb_bob, rational_polynomial, PinHole;
/// equidistant, fisheye, KannalaBrandt8. Nothing for another name.
std::optional<LensModel> lensModelNamed(const std::string& name);

/// A pinhole camera with an optional distortion, optical frame (z forward, x right, y down), pixel
/// centres at integer coordinates.
struct PinholeCamera {
  int width = 0;
  int height = 0;
  double fx = 0.0;  ///< pixels
  double fy = 0.0;  ///< pixels
  double cx = 0.0;  ///< pixels
  double cy = 0.0;  ///< pixels
  LensModel lens = LensModel::kPolynomial;
  /// kPolynomial: k1 k2 p1 p2 k3 k4 k5 k6, all zero when the images are rectified.
  /// kEquidistant: k1 k2 k3 k4.
  std::array<double, 8> distortion{};

  /// Whether images have to be rectified. Those of an equidistant lens always have.
  bool isDistorted() const;

  /// What ROS calls the model: plumb_bob, rational_polynomial (where k4 k5 k6 are used) or
  /// equidistant.
  const char* lensName() const;

  /// How many coefficients that model has: 5, 8 or 4.
  std::size_t lensCoefficients() const;

  /// The camera of the rectified images.
  PinholeCamera withoutDistortion() const;

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

/// Whether it makes no difference which of the two took an image: one size, one lens, and no pixel
/// whose ray goes through the other camera's image more than 0.01 px from it (it is farthest at a
/// corner). At 8 m that is 0.15 mm, a hundredth of what depth is known to. The same camera
/// calibrated, or written down, once more does not agree to the last bit.
bool isSameCamera(const PinholeCamera& a, const PinholeCamera& b);

/// "640 x 480, fx 525 fy 525 cx 319.5 cy 239.5".
std::string describe(const PinholeCamera& camera);

/// Throws InputError naming the first field that no real camera can have.
void validate(const PinholeCamera& camera);

}  // namespace pf
