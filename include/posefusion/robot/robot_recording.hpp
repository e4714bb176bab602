// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/robot/imu_track.hpp"

namespace pf {

/// Measurements of a robot's other sensors beside a recording, each in the order of its stamps.
struct RobotRecording {
  Trajectory odometry;  ///< of the camera, in the frame of the odometry
  std::vector<ImuSample> imu;

  bool isEmpty() const { return odometry.empty() && imu.empty(); }
};

/// Hands a recording out in the time of its frames, as a live robot does, not later than a frame
/// needs it: up to the first of each kind after the frame's stamp.
class RobotPlayback {
 public:
  RobotPlayback() = default;
  explicit RobotPlayback(RobotRecording recording) : recording_(std::move(recording)) {}

  /// `Sink` has addOdometry() and addImu().
  template <typename Sink>
  void playUntil(std::int64_t stamp_ns, Sink& sink) {
    const Trajectory& odometry = recording_.odometry;
    while (next_pose_ < odometry.size() && isDue(odometry, next_pose_, stamp_ns)) {
      sink.addOdometry(odometry[next_pose_++]);
    }
    const std::vector<ImuSample>& imu = recording_.imu;
    while (next_sample_ < imu.size() && isDue(imu, next_sample_, stamp_ns)) {
      sink.addImu(imu[next_sample_++]);
    }
  }

 private:
  template <typename List>
  static bool isDue(const List& list, std::size_t i, std::int64_t stamp_ns) {
    return i == 0 || list[i - 1].stamp_ns < stamp_ns;
  }

  RobotRecording recording_;
  std::size_t next_pose_ = 0, next_sample_ = 0;
};

}  // namespace pf
