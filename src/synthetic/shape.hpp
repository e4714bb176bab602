// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "posefusion/core/camera.hpp"
#include "texture.hpp"

namespace pf::synthetic {

/// How a surface is painted.
struct Material {
  Surface surface = Surface::plaster;
  Eigen::Vector2f repeats_per_m{1.0F, 1.0F};
  Eigen::Vector2f offset{0.0F, 0.0F};  ///< repeats
};

enum class ShapeKind { box, inside_of_box, ellipsoid, capsule };

/// A solid, placed in the room. Box and ellipsoid: half sizes along the axes. Capsule: along its z
/// axis, half.x its radius, half.z half the length of its axis.
struct Shape {
  ShapeKind kind = ShapeKind::box;
  Eigen::Isometry3f T_room_shape = Eigen::Isometry3f::Identity();
  Eigen::Vector3f half = Eigen::Vector3f::Ones();  ///< metres
  std::array<Material, 6> materials;               ///< faces -x +x -y +y -z +z
  bool is_person = false;
};

/// Where a ray first meets a shape.
struct Hit {
  float z_m = std::numeric_limits<float>::infinity();  ///< along the optical axis
  Eigen::Vector3f point;                               ///< shape frame, metres
  Eigen::Vector3f normal;                              ///< shape frame, towards the ray's side
  int face = 0;                                        ///< index into materials
};

/// A shape as seen by one camera.
class PlacedShape {
 public:
  PlacedShape(const Shape& shape, const Eigen::Isometry3f& T_room_camera,
              const PinholeCamera& camera);

  const Shape& shape() const { return *shape_; }
  /// Pixels outside of it cannot see the shape.
  const cv::Rect& pixels() const { return pixels_; }

  /// Replaces `hit` where the ray (camera frame, z = 1) meets the shape before hit.z_m.
  bool intersect(const Eigen::Vector3f& ray, Hit& hit) const;

  /// Cosine of the angle between ray (camera frame) and normal at a hit.
  float incidence(const Hit& hit, const Eigen::Vector3f& ray) const {
    return std::abs(hit.normal.dot(R_shape_camera_ * ray)) / ray.norm();
  }

  /// Surface coordinates of a hit, metres from the face's corner or along the skin.
  Eigen::Vector2f surfaceCoordinates(const Hit& hit) const;

 private:
  bool intersectBox(const Eigen::Vector3f& direction, Hit& hit) const;
  bool intersectEllipsoid(const Eigen::Vector3f& direction, Hit& hit) const;
  bool intersectCapsule(const Eigen::Vector3f& direction, Hit& hit) const;

  const Shape* shape_;
  Eigen::Matrix3f R_shape_camera_;
  Eigen::Vector3f origin_;  ///< of the camera, shape frame
  cv::Rect pixels_;
};

}  // namespace pf::synthetic
