// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/transform_replay.hpp"

#include <tf2_msgs/TFMessage.h>

#include <filesystem>

namespace posefusion_ros {

TransformReplay::TransformReplay(ros::NodeHandle& handle, const std::string& path)
    : moving_(handle.advertise<tf2_msgs::TFMessage>("/tf", 1000)),
      fixed_(handle.advertise<tf2_msgs::TFMessage>("/tf_static", 1, true)) {
  if (std::filesystem::is_directory(path)) return;
  bag_.open(path, rosbag::bagmode::Read);
  publishStatic();
  view_ = std::make_unique<rosbag::View>(bag_, rosbag::TopicQuery("/tf"));
  next_ = view_->begin();
}

void TransformReplay::publishStatic() {
  // A latched topic keeps one message: put all into one.
  tf2_msgs::TFMessage all;
  rosbag::View view(bag_, rosbag::TopicQuery("/tf_static"));
  for (const rosbag::MessageInstance& instance : view) {
    const auto message = instance.instantiate<tf2_msgs::TFMessage>();
    if (!message) continue;
    all.transforms.insert(all.transforms.end(), message->transforms.begin(),
                          message->transforms.end());
  }
  fixed_.publish(all);
}

void TransformReplay::advance(const ros::Time& stamp, double ahead_s) {
  if (!view_) return;
  const ros::Time end = stamp + ros::Duration(ahead_s);
  for (; next_ != view_->end() && next_->getTime() <= end; ++next_) {
    if (const auto message = next_->instantiate<tf2_msgs::TFMessage>()) moving_.publish(message);
  }
}

}  // namespace posefusion_ros
