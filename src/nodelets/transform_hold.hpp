// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <atomic>
#include <functional>

namespace posefusion_ros {

/// Where no frame comes at all (the driver has died) the robot still needs its transform: calls
/// `hold` with ROS time, five times a second (wall). Not where stamps are of another clock than ROS
/// time.
class TransformHold {
 public:
  TransformHold(ros::NodeHandle& handle, std::function<void(const ros::Time& now)> hold);

  /// No more calls.
  void stop() { timer_.stop(); }

  /// A frame came, whatever became of it. Thread safe.
  void heard(const ros::Time& stamp);

 private:
  void look();

  std::function<void(const ros::Time&)> hold_;
  std::atomic<bool> hears_frames_{false};  // since the last look
  std::atomic<bool> is_one_clock_{false};  // of the last stamp and ROS time
  ros::WallTimer timer_;                   // last, so that it ends first
};

}  // namespace posefusion_ros
