// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/moving_object_messages.hpp"

#include <tf2_eigen/tf2_eigen.h>

#include <string>

#include "posefusion_ros/skeleton_markers.hpp"

namespace posefusion_ros {
namespace {

using pf::MovingObject;
using visualization_msgs::Marker;

constexpr double kArrow_s = 0.5;
constexpr double kAtRest_m_s = 0.1;  // slower is noise
constexpr double kArrowWidth_m = 0.05, kArrowHead_m = 0.12, kLetters_m = 0.15;
constexpr float kOpacity = 0.3F;

geometry_msgs::Vector3 toVector(const Eigen::Vector3d& v) {
  geometry_msgs::Vector3 message;
  message.x = v.x();
  message.y = v.y();
  message.z = v.z();
  return message;
}

MovingObjectMsg messageOf(const MovingObject& object) {
  MovingObjectMsg message;
  message.id = object.id;
  message.is_person = static_cast<unsigned char>(object.is_person);
  const Eigen::AlignedBox3d box_m = object.box_m();
  message.centre = tf2::toMsg(object.centre_m);
  message.box_min = tf2::toMsg(Eigen::Vector3d(box_m.min()));
  message.box_max = tf2::toMsg(Eigen::Vector3d(box_m.max()));
  message.velocity = toVector(object.velocity_m_s);
  if (!object.is_person) return message;
  for (const Eigen::Vector3f& joint : object.joints_m) {
    message.joints.push_back(tf2::toMsg(Eigen::Vector3d(joint.cast<double>())));
  }
  return message;
}

Marker markerOf(const MovingObject& object, int type, const char* what,
                const std_msgs::Header& header) {
  Marker marker;
  marker.header = header;
  marker.ns = std::string(object.is_person ? "person " : "object ") + what;
  marker.id = object.id;
  marker.type = type;
  marker.pose.orientation.w = 1;
  marker.color.r = object.is_person ? 1.0F : 0.2F;
  marker.color.g = object.is_person ? 0.6F : 0.7F;
  marker.color.b = object.is_person ? 0.1F : 1.0F;
  marker.color.a = 1.0F;
  return marker;
}

Marker boxOf(const MovingObject& object, const std_msgs::Header& header) {
  Marker marker = markerOf(object, Marker::CUBE, "box", header);
  const Eigen::AlignedBox3d box_m = object.box_m();
  marker.pose.position = tf2::toMsg(Eigen::Vector3d(box_m.center()));
  marker.scale = toVector(box_m.sizes());
  marker.color.a = kOpacity;
  return marker;
}

Marker numberOf(const MovingObject& object, const std_msgs::Header& header) {
  Marker marker = markerOf(object, Marker::TEXT_VIEW_FACING, "number", header);
  const Eigen::AlignedBox3d box_m = object.box_m();
  const Eigen::Vector3d above_m(0, 0, box_m.sizes().z() / 2 + kLetters_m);
  marker.pose.position = tf2::toMsg(Eigen::Vector3d(box_m.center() + above_m));
  marker.scale.z = kLetters_m;
  marker.text = std::to_string(object.id);
  return marker;
}

Marker arrowOf(const MovingObject& object, const std_msgs::Header& header) {
  Marker marker = markerOf(object, Marker::ARROW, "velocity", header);
  marker.points.push_back(tf2::toMsg(object.centre_m));
  marker.points.push_back(
      tf2::toMsg(Eigen::Vector3d(object.centre_m + kArrow_s * object.velocity_m_s)));
  marker.scale.x = kArrowWidth_m;
  marker.scale.y = kArrowHead_m;
  return marker;
}

}  // namespace

MovingObjectsMsg toMessage(const std::vector<MovingObject>& objects,
                           const std_msgs::Header& header) {
  MovingObjectsMsg message;
  message.header = header;
  for (const MovingObject& object : objects) message.objects.push_back(messageOf(object));
  return message;
}

visualization_msgs::MarkerArray toMarkers(const std::vector<MovingObject>& objects,
                                          const std_msgs::Header& header) {
  visualization_msgs::MarkerArray markers = noMarkers(header);
  for (const MovingObject& object : objects) {
    markers.markers.push_back(boxOf(object, header));
    markers.markers.push_back(numberOf(object, header));
    if (object.velocity_m_s.norm() < kAtRest_m_s) continue;
    markers.markers.push_back(arrowOf(object, header));
  }
  return markers;
}

}  // namespace posefusion_ros
