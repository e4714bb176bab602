// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/robot/config.hpp"
#include "posefusion/robot/motion_prior.hpp"

namespace pf {

/// The camera's poses by the robot's odometry (legs, wheels), of the last ten seconds. They drift;
/// only motions between them are reported. Not thread safe.
class OdometryTrack {
 public:
  explicit OdometryTrack(const RobotConfig& config) : config_(config) {}

  /// T_world_camera is in the odometry's own frame, of any origin. Returns why the pose is left out
  /// (not finite, no rotation, not later than the one before); empty: it is not.
  std::string add(const StampedPose& pose);

  /// The motion between two moments, the poses interpolated, the last carried on for at most 0.05
  /// s. Nothing where no poses are near enough in time.
  std::optional<MotionPrior> between(std::int64_t from_ns, std::int64_t to_ns) const;

  void clear() { poses_.clear(); }

 private:
  std::optional<Eigen::Isometry3d> at(std::int64_t stamp_ns) const;

  RobotConfig config_;
  std::deque<StampedPose> poses_;
};

}  // namespace pf
