// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/skeleton_markers.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace posefusion_ros {
namespace {

using pf::Joint;
using pf::Keypoint;
using pf::People;
using pf::Person;
using pf::RgbdFrame;

constexpr double kLineWidth_m = 0.03;
constexpr std::array<std::array<int, 3>, 6> kColors = {
    {{255, 170, 0}, {0, 200, 255}, {120, 255, 0}, {255, 80, 160}, {170, 120, 255}, {255, 255, 0}}};

const std::array<int, 3>& colorOf(std::size_t person) { return kColors[person % kColors.size()]; }

const Keypoint& jointOf(const Person& person, Joint joint) {
  return person.joints[static_cast<std::size_t>(joint)];
}

/// Point of a joint in the camera frame; false where it was not seen or has no depth.
bool lift(const Keypoint& joint, const RgbdFrame& frame, geometry_msgs::Point& point) {
  const int u = static_cast<int>(std::lround(joint.u)), v = static_cast<int>(std::lround(joint.v));
  const cv::Mat& depth = frame.depth;
  if (joint.p <= 0 || u < 0 || v < 0 || u >= depth.cols || v >= depth.rows) return false;
  const double z = depth.type() == CV_16UC1 ? depth.at<std::uint16_t>(v, u) * frame.depth_unit_m
                                            : depth.at<float>(v, u);
  if (!(z > 0) || !std::isfinite(z)) return false;
  const Eigen::Vector3d p = frame.camera.unproject(joint.u, joint.v, z);
  point.x = p.x();
  point.y = p.y();
  point.z = p.z();
  return true;
}

visualization_msgs::Marker markerOf(const Person& person, std::size_t index, const RgbdFrame& frame,
                                    const std_msgs::Header& header) {
  visualization_msgs::Marker marker;
  marker.header = header;
  marker.ns = "people";
  marker.id = static_cast<int>(index);
  marker.type = visualization_msgs::Marker::LINE_LIST;
  marker.pose.orientation.w = 1;
  marker.scale.x = kLineWidth_m;
  marker.color.r = static_cast<float>(colorOf(index)[0]) / 255.0F;
  marker.color.g = static_cast<float>(colorOf(index)[1]) / 255.0F;
  marker.color.b = static_cast<float>(colorOf(index)[2]) / 255.0F;
  marker.color.a = 1;
  for (const auto& [from, to] : pf::kSkeletonLines) {
    geometry_msgs::Point a, b;
    if (!lift(jointOf(person, from), frame, a) || !lift(jointOf(person, to), frame, b)) continue;
    marker.points.push_back(a);
    marker.points.push_back(b);
  }
  return marker;
}

}  // namespace

visualization_msgs::MarkerArray toMarkers(const People& people, const RgbdFrame& frame,
                                          const std_msgs::Header& header) {
  visualization_msgs::MarkerArray markers;
  visualization_msgs::Marker clear;
  clear.header = header;
  clear.action = visualization_msgs::Marker::DELETEALL;
  markers.markers.push_back(clear);
  for (std::size_t i = 0; i < people.people.size(); ++i) {
    visualization_msgs::Marker marker = markerOf(people.people[i], i, frame, header);
    if (!marker.points.empty()) markers.markers.push_back(std::move(marker));
  }
  return markers;
}

}  // namespace posefusion_ros
