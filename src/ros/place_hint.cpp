// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/place_hint.hpp"

#include <ros/console.h>

#include <cmath>
#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion_ros/names.hpp"

namespace posefusion_ros {
namespace {

constexpr double kUnitLength = 0.01;  // how far a quaternion may be off

}  // namespace

Eigen::Isometry3d hintedPose(const geometry_msgs::PoseWithCovarianceStamped& message,
                             const std::string& map_frame) {
  const std::string frame = plainFrame(message.header.frame_id);
  if (frame != map_frame) {
    throw pf::InputError("is in the frame '" + frame + "', expected " + map_frame);
  }
  const auto& p = message.pose.pose.position;
  const auto& q = message.pose.pose.orientation;
  const Eigen::Quaterniond turn(q.w, q.x, q.y, q.z);
  const Eigen::Vector3d place(p.x, p.y, p.z);
  if (!place.allFinite() || !(std::abs(turn.norm() - 1) < kUnitLength)) {
    throw pf::InputError("is no pose, expected finite numbers and a quaternion of unit length");
  }
  return Eigen::Translation3d(place) * turn.normalized();
}

PlaceHint::PlaceHint(ros::NodeHandle& handle)
    : subscriber_(handle.subscribe(topics::kInitialPose, 1, &PlaceHint::onMessage, this)) {}

void PlaceHint::onMessage(const Message::ConstPtr& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  heard_ = message;
}

void PlaceHint::tell(const std_msgs::Header& image, MappingSession& session, PoseOutput& poses) {
  Message::ConstPtr heard;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    heard = std::exchange(heard_, nullptr);
  }
  if (!heard) return;
  try {
    std::string note;
    const auto T_map_camera = poses.cameraOf(image, hintedPose(*heard, poses.mapFrame()), note);
    if (!T_map_camera) throw pf::InputError(note);
    ROS_INFO("%s: %s", topics::kInitialPose, session.hint(*T_map_camera).c_str());
  } catch (const std::exception& error) {
    ROS_WARN("%s: %s", topics::kInitialPose, error.what());
  }
}

}  // namespace posefusion_ros
