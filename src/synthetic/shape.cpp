// SPDX-License-Identifier: BSD-3-Clause
#include "shape.hpp"

#include <algorithm>
#include <cmath>

namespace pf::synthetic {
namespace {

constexpr float kNearest = 0.05F;  // metres; nothing is seen closer than this

/// Pixels that the projection of the shape's bounding box can touch.
cv::Rect boundingPixels(const Shape& shape, const Eigen::Isometry3f& T_camera_shape,
                        const PinholeCamera& camera) {
  const cv::Rect image(0, 0, camera.width, camera.height);
  Eigen::Vector3f half = shape.half;
  if (shape.kind == ShapeKind::capsule) half = {half.x(), half.x(), half.z() + half.x()};
  Eigen::Array2f low(1e6F, 1e6F), high(-1e6F, -1e6F);
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3f sign(corner & 1 ? 1.0F : -1.0F, corner & 2 ? 1.0F : -1.0F,
                               corner & 4 ? 1.0F : -1.0F);
    const Eigen::Vector3f p = T_camera_shape * half.cwiseProduct(sign);
    if (p.z() < kNearest) return image;
    const Eigen::Array2f pixel = camera.project(p.cast<double>()).cast<float>().array();
    low = low.min(pixel);
    high = high.max(pixel);
  }
  low = low.max(-1e4F).min(1e4F);
  high = high.max(-1e4F).min(1e4F);
  const cv::Point first(static_cast<int>(std::floor(low.x())),
                        static_cast<int>(std::floor(low.y())));
  const cv::Point last(static_cast<int>(std::ceil(high.x())),
                       static_cast<int>(std::ceil(high.y())));
  return cv::Rect(first, last + cv::Point(1, 1)) & image;
}

}  // namespace

PlacedShape::PlacedShape(const Shape& shape, const Eigen::Isometry3f& T_room_camera,
                         const PinholeCamera& camera)
    : shape_(&shape) {
  const Eigen::Isometry3f T_shape_camera = shape.T_room_shape.inverse() * T_room_camera;
  R_shape_camera_ = T_shape_camera.linear();
  origin_ = T_shape_camera.translation();
  pixels_ = shape.kind == ShapeKind::inside_of_box
                ? cv::Rect(0, 0, camera.width, camera.height)
                : boundingPixels(shape, T_shape_camera.inverse(), camera);
}

bool PlacedShape::intersect(const Eigen::Vector3f& ray, Hit& hit) const {
  const Eigen::Vector3f direction = R_shape_camera_ * ray;
  switch (shape_->kind) {
    case ShapeKind::ellipsoid:
      return intersectEllipsoid(direction, hit);
    case ShapeKind::capsule:
      return intersectCapsule(direction, hit);
    default:
      return intersectBox(direction, hit);
  }
}

bool PlacedShape::intersectBox(const Eigen::Vector3f& direction, Hit& hit) const {
  float enter = -1e9F, leave = 1e9F;
  int enter_axis = 0, leave_axis = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float inverse = 1.0F / direction[axis];
    const float a = (-shape_->half[axis] - origin_[axis]) * inverse;
    const float b = (shape_->half[axis] - origin_[axis]) * inverse;
    const float first = std::min(a, b), second = std::max(a, b);
    if (first > enter) enter = first, enter_axis = axis;
    if (second < leave) leave = second, leave_axis = axis;
  }
  const bool inside = shape_->kind == ShapeKind::inside_of_box;
  const float z = inside ? leave : enter;
  if (enter > leave || z < kNearest || z >= hit.z_m) return false;
  const int axis = inside ? leave_axis : enter_axis;
  const bool upper = (direction[axis] > 0) == inside;
  hit.z_m = z;
  hit.point = origin_ + z * direction;
  hit.normal = Eigen::Vector3f::Zero();
  hit.normal[axis] = direction[axis] > 0 ? -1.0F : 1.0F;
  hit.face = 2 * axis + (upper ? 1 : 0);
  return true;
}

bool PlacedShape::intersectEllipsoid(const Eigen::Vector3f& direction, Hit& hit) const {
  const Eigen::Vector3f o = origin_.cwiseQuotient(shape_->half);
  const Eigen::Vector3f d = direction.cwiseQuotient(shape_->half);
  const float a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - 1.0F;
  const float discriminant = b * b - a * c;
  if (discriminant < 0) return false;
  const float z = (-b - std::sqrt(discriminant)) / a;
  if (z < kNearest || z >= hit.z_m) return false;
  hit.z_m = z;
  hit.point = origin_ + z * direction;
  hit.normal = (o + z * d).cwiseQuotient(shape_->half).normalized();
  hit.face = 0;
  return true;
}

bool PlacedShape::intersectCapsule(const Eigen::Vector3f& direction, Hit& hit) const {
  const float radius = shape_->half.x(), half_length = shape_->half.z();
  const auto accept = [&](float z, float centre) {
    if (z < kNearest || z >= hit.z_m) return false;
    hit.z_m = z;
    hit.point = origin_ + z * direction;
    hit.normal = (hit.point - Eigen::Vector3f(0, 0, centre)) / radius;
    hit.face = 0;
    return true;
  };
  const Eigen::Vector2f o = origin_.head<2>(), d = direction.head<2>();
  const float a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - radius * radius;
  const float discriminant = b * b - a * c;
  if (discriminant < 0) return false;
  const float side = (-b - std::sqrt(discriminant)) / std::max(a, 1e-12F);
  const float along = origin_.z() + side * direction.z();
  if (std::abs(along) <= half_length) return accept(side, along);
  const float end = along > 0 ? half_length : -half_length;
  const Eigen::Vector3f from = origin_ - Eigen::Vector3f(0, 0, end);
  const float sa = direction.squaredNorm(), sb = from.dot(direction);
  const float s = sb * sb - sa * (from.squaredNorm() - radius * radius);
  return s >= 0 && accept((-sb - std::sqrt(s)) / sa, end);
}

Eigen::Vector2f PlacedShape::surfaceCoordinates(const Hit& hit) const {
  if (shape_->kind == ShapeKind::ellipsoid || shape_->kind == ShapeKind::capsule)
    return {std::atan2(hit.point.y(), hit.point.x()) * shape_->half.x(),
            hit.point.z() + shape_->half.z()};
  const Eigen::Vector3f corner = hit.point + shape_->half;
  switch (hit.face / 2) {
    case 0:
      return {corner.y(), corner.z()};
    case 1:
      return {corner.x(), corner.z()};
    default:
      return {corner.x(), corner.y()};
  }
}

}  // namespace pf::synthetic
