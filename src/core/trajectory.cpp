// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/trajectory.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>

#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

constexpr std::int64_t kMaxDifference_ns = 20'000'000;

}  // namespace

Eigen::Isometry3d levelFromOptical(const Eigen::Vector3d& up) {
  const Eigen::Vector3d z = up.normalized();
  Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ() - z.z() * z;
  // Looking straight up or down: the top of the picture is ahead.
  if (ahead.norm() < 0.1) ahead = -Eigen::Vector3d::UnitY() + z.y() * z;
  const Eigen::Vector3d x = ahead.normalized();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear().row(0) = x;
  T.linear().row(1) = z.cross(x);
  T.linear().row(2) = z;
  return T;
}

Eigen::Isometry3d poseBetween(const StampedPose& a, const StampedPose& b, std::int64_t stamp_ns) {
  const double part = static_cast<double>(stamp_ns - a.stamp_ns) /
                      static_cast<double>(std::max<std::int64_t>(1, b.stamp_ns - a.stamp_ns));
  const Eigen::Isometry3d &A = a.T_world_camera, &B = b.T_world_camera;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = A.linear() * expSo3(part * logSo3(A.linear().transpose() * B.linear()));
  T.translation() = (1.0 - part) * A.translation() + part * B.translation();
  return T;
}

std::optional<Eigen::Isometry3d> poseAt(const Trajectory& poses, std::int64_t stamp_ns) {
  const auto after =
      std::lower_bound(poses.begin(), poses.end(), stamp_ns,
                       [](const StampedPose& p, std::int64_t stamp) { return p.stamp_ns < stamp; });
  const auto isNear = [&](const StampedPose& p) {
    return std::llabs(p.stamp_ns - stamp_ns) < kMaxDifference_ns;
  };
  const bool has_after = after != poses.end(), has_before = after != poses.begin();
  const bool near = (has_after && isNear(*after)) || (has_before && isNear(*std::prev(after)));
  if (!near) return std::nullopt;
  if (!has_after) return poses.back().T_world_camera;
  if (!has_before) return poses.front().T_world_camera;
  return poseBetween(*std::prev(after), *after, stamp_ns);
}

}  // namespace pf
