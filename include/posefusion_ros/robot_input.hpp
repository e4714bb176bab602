// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nav_msgs/Odometry.h>
#include <ros/node_handle.h>
#include <sensor_msgs/Imu.h>

#include <deque>
#include <memory>
#include <mutex>
#include <string>

#include "posefusion/robot/imu_track.hpp"
#include "posefusion_ros/mapping_session.hpp"
#include "posefusion_ros/parameters.hpp"
#include "posefusion_ros/transforms.hpp"

namespace posefusion_ros {

/// Which of the robot's other sensors measure the camera's motion.
struct RobotInputSettings {
  std::string imu_topic;          ///< sensor_msgs/Imu; empty: none
  std::string odometry_topic;     ///< nav_msgs/Odometry; empty: none
  bool odometry_from_tf = false;  ///< the transform of odom_frame instead
  std::string odom_frame;
};

/// Reads `imu_topic`, `odometry_topic` and `odometry_from_tf`. Throws InputError where they
/// contradict each other.
RobotInputSettings readRobotInput(Parameters& parameters, const std::string& odom_frame);

/// A sample in the camera's axes.
pf::ImuSample toImuSample(const sensor_msgs::Imu& message, const Eigen::Matrix3d& R_camera_imu);

/// The camera's pose by an odometry that is that of another body. Not rigid where the message's
/// quaternion is not of unit length.
pf::StampedPose toOdometryPose(const nav_msgs::Odometry& message,
                               const Eigen::Isometry3d& T_child_camera);

/// Hears the robot's odometry and inertial sensor, and hands them to mapping in the camera's axes,
/// frame by frame. Nothing is waited for: what is late counts for the next frame.
class RobotInput {
 public:
  RobotInput(ros::NodeHandle& handle, const RobotInputSettings& settings);

  /// In the worker, before a frame: all that is needed up to its stamp. Returns what could not be
  /// used for want of a transform; empty: nothing.
  std::string tell(const std_msgs::Header& image, MappingSession& session);

 private:
  void onImu(const sensor_msgs::Imu::ConstPtr& message);
  void onOdometry(const nav_msgs::Odometry::ConstPtr& message);
  void tellImu(const std_msgs::Header& image, MappingSession& session, std::string& trouble);
  void tellOdometry(const std_msgs::Header& image, MappingSession& session, std::string& trouble);

  RobotInputSettings settings_;
  std::unique_ptr<ListeningLookup> lookup_;  // null: nothing is heard
  std::mutex mutex_;
  std::deque<sensor_msgs::Imu::ConstPtr> imu_;
  std::deque<nav_msgs::Odometry::ConstPtr> odometry_;
  std::string imu_frame_;  // that the mount is known of
  Eigen::Matrix3d R_camera_imu_ = Eigen::Matrix3d::Identity();
  ros::Subscriber imu_subscriber_, odometry_subscriber_;
};

}  // namespace posefusion_ros
