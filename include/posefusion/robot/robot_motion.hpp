// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "posefusion/robot/imu_track.hpp"
#include "posefusion/robot/motion_trust.hpp"
#include "posefusion/robot/odometry_track.hpp"

namespace pf {

/// What became of one source of motions.
struct MotionSourceReport {
  std::uint64_t received = 0;  ///< poses or samples
  std::uint64_t left_out = 0;  ///< of them: unusable
  std::string why_left_out;    ///< the last of those
  std::uint64_t told = 0;      ///< motions between frames that it measured
  std::uint64_t missing = 0;   ///< between frames, while it was sent: not there, or not in time
  bool is_believed = false;
};

/// The camera's motion by the robot's other sensors: odometry and an inertial sensor, each believed
/// as long as it agrees with the images. Odometry is not used while the robot falls. What is late
/// or missing is done without. Not thread safe.
class RobotMotion {
 public:
  explicit RobotMotion(const RobotConfig& config) : odometry_(config), imu_(config) {}

  void addOdometry(const StampedPose& pose);  ///< see OdometryTrack::add()
  void addImu(const ImuSample& sample);

  /// What is known of the motion between two frames; nothing where no sensor is believed.
  std::optional<MotionPrior> between(std::int64_t from_ns, std::int64_t to_ns);

  /// The motion as the images show it, with its covariance (twist in the later camera).
  void compare(std::int64_t from_ns, std::int64_t to_ns, const Eigen::Isometry3d& T_seen,
               const Matrix6d& covariance);

  /// See ImuTrack.
  std::optional<Eigen::Vector3d> feltBetween(std::int64_t from_ns, std::int64_t to_ns) const {
    return imu_.feltBetween(from_ns, to_ns);
  }

  /// The clock was put back: what was sent before is forgotten, and so is trust.
  void restart();

  const MotionSourceReport& odometry() const { return odometry_report_; }
  const MotionSourceReport& imu() const { return imu_report_; }

 private:
  OdometryTrack odometry_;
  ImuTrack imu_;
  MotionTrust odometry_trust_, imu_trust_;
  MotionSourceReport odometry_report_, imu_report_;
};

}  // namespace pf
