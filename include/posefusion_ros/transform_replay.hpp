// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <memory>
#include <string>

namespace posefusion_ros {

/// Publishes the transforms recorded in a bag, in step with its frames.
class TransformReplay {
 public:
  /// Publishes all of /tf_static at once. A folder instead of a bag has no transforms.
  TransformReplay(ros::NodeHandle& handle, const std::string& path);

  /// Publishes /tf up to `ahead_s` after the stamp: a lookup at the stamp needs a later one.
  void advance(const ros::Time& stamp, double ahead_s = 0.2);

 private:
  void publishStatic();

  rosbag::Bag bag_;
  std::unique_ptr<rosbag::View> view_;
  rosbag::View::iterator next_;
  ros::Publisher moving_, fixed_;
};

}  // namespace posefusion_ros
