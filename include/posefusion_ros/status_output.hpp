// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <visualization_msgs/Marker.h>

#include <mutex>
#include <string>

#include "posefusion_ros/bags/messages.hpp"

namespace posefusion_ros {

/// The state of tracking as a text that stands above the camera, for rviz: green while tracking,
/// yellow in doubt, red while lost. `lost_s`: for how long.
visualization_msgs::Marker toStateText(const TrackingStatusMsg& status, double lost_s);

/// Publishes the status of each frame and, with subscribers, the state as a text. Thread safe.
class StatusOutput {
 public:
  /// From now on statuses are sent; those before are not.
  void advertise(ros::NodeHandle& handle);

  void publish(const TrackingStatusMsg& status);

  /// Takes the text away: the state is not known any more.
  void clearText();

 private:
  std::mutex mutex_;
  ros::Publisher status_, text_;
  ros::Time known_;  // newest stamp at which the camera was not lost
  visualization_msgs::Marker shown_;
};

}  // namespace posefusion_ros
