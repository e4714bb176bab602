// SPDX-License-Identifier: BSD-3-Clause
// Measurements of the robot's other sensors.
#include "mapper_state.hpp"
#include "posefusion/core/stamps.hpp"

namespace pf {

/// Compares the robot's other sensors with the motion that the images show, where they determine
/// all of it.
void Mapper::State::checkRobot(const Location& location, const std::optional<MapPose>& before,
                               std::int64_t before_ns) {
  if (!before || location.outcome != FrameOutcome::fused || location.is_return ||
      location.tracking.free_directions > 0) {
    return;
  }
  robot.compare(before_ns, last_stamp_ns, before->T_map_camera.inverse() * location.T_map_camera,
                location.covariance);
  const auto felt = robot.feltBetween(before_ns, last_stamp_ns);
  if (!felt || location.fragment != kFirstFragment) return;
  gravity.add(location.T_map_camera.linear() * *felt, secondsBetween(before_ns, last_stamp_ns));
}

void Mapper::addOdometry(const StampedPose& pose) { state_->robot.addOdometry(pose); }

void Mapper::addImu(const ImuSample& sample) { state_->robot.addImu(sample); }

const RobotMotion& Mapper::robot() const { return state_->robot; }

Eigen::Isometry3d Mapper::worldFromMap() const {
  return state_->worldFromMap().value_or(bodyFromOptical());
}

/// As set by place(), or from gravity; nothing where neither is known.
std::optional<Eigen::Isometry3d> Mapper::State::worldFromMap() const {
  if (T_world_map) return T_world_map;
  const auto up = gravity.up();
  if (!up) return std::nullopt;
  return levelFromOptical(*up);
}

}  // namespace pf
