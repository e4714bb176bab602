// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/moving_object.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace pf {
namespace {

constexpr double kVelocityMemory_s = 0.3;

}  // namespace

SkeletonPoints unknownSkeleton() {
  SkeletonPoints points;
  points.fill(Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  return points;
}

void MovingObject::placeAt(std::vector<Eigen::Vector3f> points, double elapsed_s) {
  const bool is_new = points_m.empty();
  const Eigen::Vector3d before_m = centre_m;
  points_m = std::move(points);
  centre_m.setZero();
  for (const Eigen::Vector3f& point : points_m) centre_m += point.cast<double>();
  centre_m /= static_cast<double>(points_m.size());
  if (is_new || elapsed_s <= 0) return;
  const double share = std::min(1.0, elapsed_s / kVelocityMemory_s);
  velocity_m_s += share * ((centre_m - before_m) / elapsed_s - velocity_m_s);
}

Eigen::AlignedBox3d MovingObject::box_m() const {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& point : points_m) box.extend(point.cast<double>());
  return box;
}

MovingObject MovingObject::in(const Eigen::Isometry3d& T) const {
  MovingObject there = *this;
  const Eigen::Isometry3f T_points = T.cast<float>();
  for (Eigen::Vector3f& point : there.points_m) point = T_points * point;
  for (Eigen::Vector3f& joint : there.joints_m) joint = T_points * joint;
  there.centre_m = T * centre_m;
  there.velocity_m_s = T.linear() * velocity_m_s;
  return there;
}

}  // namespace pf
