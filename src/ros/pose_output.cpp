// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/pose_output.hpp"

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Odometry.h>
#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>

#include "posefusion/core/se3.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/bags/stage_messages.hpp"
#include "posefusion_ros/names.hpp"

namespace posefusion_ros {
namespace {

constexpr int kPoseQueue = 10;
// The path keeps ten poses a second: a whole day stays small enough to be sent.
const ros::Duration kPathStep(0.1);

/// `covariance`: of the twist in the camera frame.
geometry_msgs::PoseWithCovariance withCovariance(const Eigen::Isometry3d& T_map_base,
                                                 const Eigen::Isometry3d& T_base_camera,
                                                 const pf::Matrix6d& covariance) {
  geometry_msgs::PoseWithCovariance pose;
  pose.pose = toPose(T_map_base);
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(pose.covariance.data()) =
      poseCovariance(T_map_base, T_base_camera, covariance);
  return pose;
}

}  // namespace

struct PoseOutput::Links {
  std::string base;
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_odom_base = Eigen::Isometry3d::Identity();
};

PoseOutputSettings readPoseOutput(Parameters& parameters, bool lossless) {
  PoseOutputSettings settings;
  settings.publish_tf = parameters.flag("publish_tf", settings.publish_tf);
  settings.tf_while_lost = parameters.flag("tf_while_lost", settings.tf_while_lost);
  settings.map_frame = plainFrame(parameters.text("map_frame", frames::kMap));
  settings.odom_frame = plainFrame(parameters.text("odom_frame", ""));
  settings.base_frame = plainFrame(parameters.text("base_frame", ""));
  settings.lookup = readLookup(parameters, lossless);
  ParameterFields fields(parameters);
  visitFields(settings.publishing, fields);
  return settings;
}

PoseOutput::PoseOutput(ros::NodeHandle& handle, const PoseOutputSettings& settings)
    : settings_(settings),
      odometry_(handle.advertise<nav_msgs::Odometry>(topics::kOdometry, kPoseQueue)),
      pose_(handle.advertise<geometry_msgs::PoseStamped>(topics::kPose, kPoseQueue)),
      pose_with_covariance_(handle.advertise<geometry_msgs::PoseWithCovarianceStamped>(
          topics::kPoseWithCovariance, kPoseQueue)),
      provisional_(handle.advertise<geometry_msgs::PoseWithCovarianceStamped>(
          topics::kProvisionalPose, kPoseQueue)),
      path_publisher_(handle.advertise<nav_msgs::Path>(topics::kPath, 1, true)) {
  if (!settings.base_frame.empty() || !settings.odom_frame.empty()) {
    lookup_ = std::make_unique<ListeningLookup>(settings.lookup);
  }
  if (settings.publish_tf) parents_ = std::make_unique<ListeningParentWatch>(handle);
  reset();
}

void PoseOutput::reset() {
  is_loaded_ = false;
  T_map_start_.reset();
  T_map_odom_.reset();
  restartClock();
}

void PoseOutput::restartClock() {
  path_mounts_.clear();
  T_map_base_before_.reset();
  path_.poses.clear();
  path_.header.frame_id = settings_.map_frame;
  path_sent_ = sent_ = ros::Time();
}

void PoseOutput::load(const std::optional<Eigen::Isometry3d>& T_map_start) {
  reset();
  is_loaded_ = true;
  T_map_start_ = T_map_start;
}

bool PoseOutput::lookAtMount(const std_msgs::Header& image, Links& links, std::string& note) {
  const std::string camera = plainFrame(image.frame_id);
  links.base = settings_.base_frame.empty() ? camera : settings_.base_frame;
  if (links.base == camera) return true;
  const auto T = (*lookup_)->find(links.base, camera, image.stamp, note);
  if (T) links.T_base_camera = *T;
  return T.has_value();
}

std::optional<Eigen::Isometry3d> PoseOutput::cameraOf(const std_msgs::Header& image,
                                                      const Eigen::Isometry3d& T_map_base,
                                                      std::string& note) {
  Links links;
  if (!lookAtMount(image, links, note)) return std::nullopt;
  const bool has_base = links.base != plainFrame(image.frame_id);
  return T_map_base * (has_base ? links.T_base_camera : pf::bodyFromOptical());
}

bool PoseOutput::look(const std_msgs::Header& image, Links& links, std::string& note) {
  if (!lookAtMount(image, links, note)) return false;
  if (!settings_.odom_frame.empty()) {
    std::string of_odometry;
    const auto T = (*lookup_)->find(settings_.odom_frame, links.base, image.stamp, of_odometry);
    if (!of_odometry.empty()) note = of_odometry;
    if (!T) return false;
    links.T_odom_base = *T;
  }
  return true;
}

bool PoseOutput::publish(const std_msgs::Header& image, const pf::FrameStatus& status,
                         std::string& note) {
  Links links;
  note.clear();
  if (!look(image, links, note)) return false;
  const bool has_robot = !settings_.base_frame.empty() || !settings_.odom_frame.empty();
  if (!T_map_start_) {
    const Eigen::Isometry3d T_body_camera = has_robot ? links.T_base_camera : pf::bodyFromOptical();
    T_map_start_ = is_loaded_ ? T_body_camera
                              : links.T_odom_base * T_body_camera * status.T_map_camera.inverse();
  }
  const Eigen::Isometry3d T_map_camera = *T_map_start_ * status.T_map_camera;
  const Eigen::Isometry3d T_map_base = T_map_camera * links.T_base_camera.inverse();
  if (settings_.publish_tf) {
    const bool has_odometry = !settings_.odom_frame.empty();
    if (has_odometry) T_map_odom_ = T_map_base * links.T_odom_base.inverse();
    const std::string unsent =
        sendTransform(image.stamp, has_odometry ? settings_.odom_frame : links.base,
                      has_odometry ? *T_map_odom_ : T_map_base);
    if (!unsent.empty()) note = unsent;
  }
  sendOdometry(image.stamp, links, T_map_base, status.covariance);
  geometry_msgs::PoseWithCovarianceStamped with_covariance;
  with_covariance.header.stamp = image.stamp;
  with_covariance.header.frame_id = settings_.map_frame;
  with_covariance.pose = withCovariance(T_map_base, links.T_base_camera, status.covariance);
  pose_with_covariance_.publish(with_covariance);
  geometry_msgs::PoseStamped pose;
  pose.header = with_covariance.header;
  pose.pose = with_covariance.pose.pose;
  pose_.publish(pose);
  extendPath(pose, links.T_base_camera);
  return true;
}

void PoseOutput::publishProvisional(const std_msgs::Header& image,
                                    const pf::ProvisionalPose& pose) {
  Links links;
  std::string unused;
  if (!T_map_start_ || !look(image, links, unused)) return;
  const Eigen::Isometry3d T_map_base =
      *T_map_start_ * pose.T_map_camera * links.T_base_camera.inverse();
  geometry_msgs::PoseWithCovarianceStamped message;
  message.header.stamp = image.stamp;
  message.header.frame_id = settings_.map_frame;
  message.pose = withCovariance(T_map_base, links.T_base_camera, pose.covariance);
  provisional_.publish(message);
}

void PoseOutput::hold(const ros::Time& stamp) {
  if (!settings_.publish_tf || !settings_.tf_while_lost || !T_map_odom_ || stamp <= sent_) return;
  sendTransform(stamp, settings_.odom_frame, *T_map_odom_);
}

void PoseOutput::correct(const pf::Trajectory& corrected) {
  if (!T_map_start_) return;
  // From the end: where the clock was put back, stamps before have nothing to do with the path.
  auto camera = corrected.rbegin();
  for (std::size_t i = path_.poses.size(); i-- > 0;) {
    geometry_msgs::PoseStamped& pose = path_.poses[i];
    while (camera != corrected.rend() && camera->stamp_ns > toNs(pose.header.stamp)) ++camera;
    if (camera == corrected.rend()) break;
    if (camera->stamp_ns != toNs(pose.header.stamp)) continue;
    pose.pose = toPose(*T_map_start_ * camera->T_world_camera * path_mounts_[i].inverse());
  }
  T_map_base_before_.reset();  // the step of a correction is no motion
  path_sent_ = ros::Time();
}

std::string PoseOutput::sendTransform(const ros::Time& stamp, const std::string& child,
                                      const Eigen::Isometry3d& T) {
  // The first publisher goes on sending: two that hear each other would both fall silent.
  const std::string conflict = sends_ ? "" : parents_->conflict(child, settings_.map_frame);
  sends_ = conflict.empty();
  if (!sends_) {
    return "no transform is sent: " + conflict + "; " +
           parents_->advice(child, settings_.map_frame);
  }
  geometry_msgs::TransformStamped message = tf2::eigenToTransform(T);
  message.header.stamp = stamp;
  message.header.frame_id = settings_.map_frame;
  message.child_frame_id = child;
  broadcaster_.sendTransform(message);
  sent_ = std::max(sent_, stamp);
  return {};
}

void PoseOutput::sendOdometry(const ros::Time& stamp, const Links& links,
                              const Eigen::Isometry3d& T_map_base, const pf::Matrix6d& covariance) {
  nav_msgs::Odometry odometry;
  odometry.header.stamp = stamp;
  odometry.header.frame_id = settings_.map_frame;
  odometry.child_frame_id = links.base;
  odometry.pose = withCovariance(T_map_base, links.T_base_camera, covariance);
  if (T_map_base_before_ && stamp > before_) {
    const pf::Vector6d twist =
        pf::logSe3(T_map_base_before_->inverse() * T_map_base) / (stamp - before_).toSec();
    odometry.twist.twist.linear =
        tf2::toMsg(Eigen::Vector3d(twist.head<3>()), odometry.twist.twist.linear);
    odometry.twist.twist.angular =
        tf2::toMsg(Eigen::Vector3d(twist.tail<3>()), odometry.twist.twist.angular);
  }
  odometry_.publish(odometry);
  T_map_base_before_ = T_map_base;
  before_ = stamp;
}

void PoseOutput::extendPath(const geometry_msgs::PoseStamped& pose,
                            const Eigen::Isometry3d& T_base_camera) {
  const ros::Time stamp = pose.header.stamp;
  if (path_.poses.empty() || stamp - path_.poses.back().header.stamp >= kPathStep) {
    path_.poses.push_back(pose);
    path_mounts_.push_back(T_base_camera);
  }
  if (!path_sent_.isZero() && (stamp - path_sent_).toSec() < settings_.publishing.path_period_s)
    return;
  path_.header.stamp = stamp;
  path_sent_ = stamp;
  if (path_publisher_.getNumSubscribers() > 0) path_publisher_.publish(path_);
}

}  // namespace posefusion_ros
