// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/transforms.hpp"

#include <ros/init.h>
#include <tf2_eigen/tf2_eigen.h>

#include <cmath>
#include <iomanip>
#include <sstream>

#include "posefusion/core/symmetric.hpp"

namespace posefusion_ros {
namespace {

constexpr double kPoll_s = 0.002;

}  // namespace

std::string plainFrame(const std::string& frame_id) {
  return !frame_id.empty() && frame_id.front() == '/' ? frame_id.substr(1) : frame_id;
}

pf::Matrix6d poseCovariance(const Eigen::Isometry3d& T_parent_body,
                            const Eigen::Isometry3d& T_body_camera, const pf::Matrix6d& camera) {
  // The body's motion in its own axes, then turned into the axes of the parent.
  const Eigen::Matrix3d R = (T_parent_body * T_body_camera).linear();
  pf::Matrix6d J = pf::Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = R;
  J.topRightCorner<3, 3>() =
      T_parent_body.linear() * pf::hat(T_body_camera.translation()) * T_body_camera.linear();
  J.bottomRightCorner<3, 3>() = R;
  return pf::propagated(J, camera);
}

LookupSettings readLookup(Parameters& parameters, bool lossless) {
  LookupSettings settings;
  settings.timeout_s = parameters.number("tf_timeout_s", settings.timeout_s, {0.0, 10.0});
  settings.max_age_s = parameters.number("tf_max_age_s", settings.max_age_s, {0.0, 10.0});
  settings.exact = lossless;
  return settings;
}

std::optional<Eigen::Isometry3d> TransformLookup::find(const std::string& target,
                                                       const std::string& source,
                                                       const ros::Time& stamp, std::string& note) {
  bool& waits = waits_.try_emplace({target, source}, true).first->second;
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(settings_.timeout_s);
  auto T = look(target, source, stamp, note);
  while (!T && waits && ros::WallTime::now() < end && !ros::isShuttingDown()) {
    ros::WallDuration(kPoll_s).sleep();
    T = look(target, source, stamp, note);
  }
  waits = settings_.exact && T.has_value();
  return T;
}

std::optional<Eigen::Isometry3d> TransformLookup::look(const std::string& target,
                                                       const std::string& source,
                                                       const ros::Time& stamp,
                                                       std::string& note) const {
  // Looked up before that of the stamp: a transform that comes between the two lookups would else
  // be called older than the image.
  const auto newest = settings_.exact ? std::nullopt : at(target, source, ros::Time(0), note);
  const auto T = at(target, source, stamp, note);
  if (T) return tf2::transformToEigen(*T);
  if (!newest) return std::nullopt;
  const double age_s = (stamp - newest->header.stamp).toSec();
  if (std::abs(age_s) > settings_.max_age_s) return std::nullopt;
  std::ostringstream text;
  text << "the transform from " << source << " to " << target << " is " << std::fixed
       << std::setprecision(3) << age_s << " s older than the image";
  note = text.str();
  return tf2::transformToEigen(*newest);
}

std::optional<geometry_msgs::TransformStamped> TransformLookup::at(const std::string& target,
                                                                   const std::string& source,
                                                                   const ros::Time& stamp,
                                                                   std::string& note) const {
  try {
    auto T = buffer_.lookupTransform(target, source, stamp);
    note.clear();
    return T;
  } catch (const tf2::TransformException& exception) {
    note = "no transform from " + source + " to " + target + ": " + exception.what();
    return std::nullopt;
  }
}

}  // namespace posefusion_ros
