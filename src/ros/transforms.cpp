// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/transforms.hpp"

#include <ros/init.h>
#include <tf2_eigen/tf2_eigen.h>

namespace posefusion_ros {
namespace {

constexpr double kPollS = 0.002;

}  // namespace

std::string plainFrame(const std::string& frame_id) {
  return !frame_id.empty() && frame_id.front() == '/' ? frame_id.substr(1) : frame_id;
}

Eigen::Isometry3d bodyFromOptical() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return T;
}

std::optional<Eigen::Isometry3d> TransformLookup::find(const std::string& target,
                                                       const std::string& source,
                                                       const ros::Time& stamp,
                                                       std::string& error) const {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(timeout_s_);
  while (!buffer_.canTransform(target, source, stamp) && ros::WallTime::now() < end && ros::ok()) {
    ros::WallDuration(kPollS).sleep();
  }
  try {
    return tf2::transformToEigen(buffer_.lookupTransform(target, source, stamp));
  } catch (const tf2::TransformException& exception) {
    error = "no transform from " + source + " to " + target + ": " + exception.what();
    return std::nullopt;
  }
}

}  // namespace posefusion_ros
