// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/robot/odometry_track.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/stamps.hpp"

namespace pf {
namespace {

constexpr double kOdometryKept_s = 10.0, kOdometryCarriedOn_s = 0.05;

}  // namespace

std::string OdometryTrack::add(const StampedPose& pose) {
  if (!isRigid(pose.T_world_camera)) return "the pose is no rigid motion, or not finite";
  if (!poses_.empty() && pose.stamp_ns <= poses_.back().stamp_ns) {
    return "stamp " + formatStamp(pose.stamp_ns) + " is not later than the one before, " +
           formatStamp(poses_.back().stamp_ns);
  }
  poses_.push_back(pose);
  while (secondsBetween(poses_.front().stamp_ns, pose.stamp_ns) > kOdometryKept_s)
    poses_.pop_front();
  return {};
}

std::optional<Eigen::Isometry3d> OdometryTrack::at(std::int64_t stamp_ns) const {
  if (poses_.size() < 2 || stamp_ns < poses_.front().stamp_ns) return std::nullopt;
  auto after = std::lower_bound(poses_.begin(), poses_.end(), stamp_ns,
                                [](const auto& p, std::int64_t t) { return p.stamp_ns < t; });
  const bool is_beyond = after == poses_.end();
  if (is_beyond || after == poses_.begin()) after = is_beyond ? after - 1 : after + 1;
  const StampedPose &a = *(after - 1), &b = *after;
  if (secondsBetween(a.stamp_ns, b.stamp_ns) > config_.odometry_max_gap_s) return std::nullopt;
  if (is_beyond && secondsBetween(b.stamp_ns, stamp_ns) > kOdometryCarriedOn_s) return std::nullopt;
  return poseBetween(a, b, stamp_ns);
}

std::optional<MotionPrior> OdometryTrack::between(std::int64_t from_ns, std::int64_t to_ns) const {
  const auto from = at(from_ns), to = at(to_ns);
  if (!from || !to || from_ns >= to_ns) return std::nullopt;
  MotionPrior prior;
  prior.has_shift = true;
  prior.T_before_after = orthonormalised(from->inverse() * *to);
  const double way_m = prior.T_before_after.translation().norm();
  const double turn_rad = angleOf(prior.T_before_after);
  prior.covariance = independentCovariance(
      std::hypot(config_.odometry_step_m, config_.odometry_per_m * way_m),
      std::hypot(config_.odometry_step_rad, config_.odometry_per_rad * turn_rad));
  return prior;
}

}  // namespace pf
