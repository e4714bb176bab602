// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <ros/node_handle.h>

#include <mutex>

#include "posefusion_ros/mapping_session.hpp"
#include "posefusion_ros/pose_output.hpp"

namespace posefusion_ros {

/// The pose of a message, where it can be one. Throws InputError where its frame is not `map_frame`
/// or its numbers make no pose.
Eigen::Isometry3d hintedPose(const geometry_msgs::PoseWithCovarianceStamped& message,
                             const std::string& map_frame);

/// Receives a user's hint of the robot's place (`initialpose`, as rviz sends it): a lost camera is
/// searched for there too.
class PlaceHint {
 public:
  explicit PlaceHint(ros::NodeHandle& handle);

  /// In the worker, before a frame: hands on what was heard last, and logs what comes of it.
  void tell(const std_msgs::Header& image, MappingSession& session, PoseOutput& poses);

 private:
  using Message = geometry_msgs::PoseWithCovarianceStamped;

  void onMessage(const Message::ConstPtr& message);

  std::mutex mutex_;
  Message::ConstPtr heard_;
  ros::Subscriber subscriber_;
};

}  // namespace posefusion_ros
