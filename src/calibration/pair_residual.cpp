// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/pair_residual.hpp"

#include <cmath>

namespace pf {
namespace {

constexpr double kFacing = 0.85;    // cosine between the normals
constexpr double kNearest_m = 0.3;  // of a point seen from the other view

FieldWeights weightsOf(const DepthField& field, double u, double v, const PinholeCamera& camera) {
  return field.weights((u + 0.5) / camera.width, (v + 0.5) / camera.height);
}

/// How d changes with the pixel.
Eigen::RowVector2d slopeOf(const DepthField& field, const FieldWeights& w,
                           const PinholeCamera& camera) {
  const auto slope = field.slopeAt(w);
  return {slope[0] / camera.width, slope[1] / camera.height};
}

}  // namespace

std::optional<PairResidual> pairResidual(const SurfacePatch& patch, const ViewSurface& from,
                                         const ViewSurface& to, const Eigen::Isometry3d& T_to_from,
                                         const DepthField& field) {
  PairResidual r;
  r.at_from = weightsOf(field, patch.u, patch.v, from.camera());
  const double w = patch.w + field.at(r.at_from);
  if (!(w > 0)) return std::nullopt;
  const Eigen::Vector3d ray = T_to_from.linear() * from.camera().unproject(patch.u, patch.v, 1.0);
  const Eigen::Vector3d q = ray / w + T_to_from.translation();
  if (q.z() < kNearest_m) return std::nullopt;
  const PinholeCamera& camera = to.camera();
  const Eigen::Vector2d pixel = camera.project(q);
  const SurfacePatch* other = to.near(pixel.x(), pixel.y());
  if (other == nullptr) return std::nullopt;
  const Eigen::Vector3d normal = other->normal.cast<double>();
  if ((T_to_from.linear() * patch.normal.cast<double>()).dot(normal) < kFacing) {
    return std::nullopt;
  }
  r.pixel_u = pixel.x();
  r.pixel_v = pixel.y();
  r.at_to = weightsOf(field, r.pixel_u, r.pixel_v, camera);
  const Eigen::RowVector2d plane(other->by_u, other->by_v);
  const double seen =
      other->w + plane.dot(pixel - Eigen::Vector2d(other->u, other->v)) + field.at(r.at_to);
  if (!(seen > 0)) return std::nullopt;
  r.e = 1.0 / q.z() - seen;

  const double z = q.z();
  Eigen::Matrix<double, 2, 3> by_point;
  by_point << camera.fx / z, 0, -camera.fx * q.x() / (z * z), 0, camera.fy / z,
      -camera.fy * q.y() / (z * z);
  Eigen::RowVector3d e_by_point = -(plane + slopeOf(field, r.at_to, camera)) * by_point;
  e_by_point.z() -= 1.0 / (z * z);
  r.by_from = -e_by_point.dot(ray) / (w * w);
  r.by_to = -1.0;
  r.by_pose << e_by_point.transpose(), q.cross(e_by_point.transpose());
  r.variance = r.by_from * r.by_from * patch.sigma * patch.sigma + other->sigma * other->sigma;
  // Along the ray e moves the point by z^2 e on the axis; its share along the normal.
  r.metres = std::abs(normal.dot(q)) / seen;
  return r;
}

}  // namespace pf
