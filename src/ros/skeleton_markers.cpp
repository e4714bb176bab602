// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/skeleton_markers.hpp"

#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace posefusion_ros {
namespace {

using pf::Keypoint;
using pf::People;
using pf::Person;
using pf::RgbdFrame;

constexpr double kLineWidth_m = 0.03;
// From the middle of a body: an arm stretched towards the camera. More is the depth of what is
// behind, seen past a thin limb.
constexpr double kReach_m = 0.9;
constexpr double kLongestBone_m = 0.9;
constexpr std::array<std::array<int, 3>, 6> kColors = {
    {{255, 170, 0}, {0, 200, 255}, {120, 255, 0}, {255, 80, 160}, {170, 120, 255}, {255, 255, 0}}};

const std::array<int, 3>& colorOf(std::size_t person) { return kColors[person % kColors.size()]; }

/// Point of a joint in the camera frame; nothing where it was not seen or has no depth.
std::optional<Eigen::Vector3d> lift(const Keypoint& joint, const RgbdFrame& frame) {
  const int u = static_cast<int>(std::lround(joint.u)), v = static_cast<int>(std::lround(joint.v));
  const cv::Mat& depth = frame.depth;
  if (joint.p <= 0 || u < 0 || v < 0 || u >= depth.cols || v >= depth.rows) return std::nullopt;
  const double z = depth.type() == CV_16UC1 ? depth.at<std::uint16_t>(v, u) * frame.depth_unit_m
                                            : depth.at<float>(v, u);
  if (!(z > 0) || !std::isfinite(z)) return std::nullopt;
  return frame.camera.unproject(joint.u, joint.v, z);
}

/// Points of all joints of a person, those left out that lie far before or behind most of them.
std::vector<std::optional<Eigen::Vector3d>> liftPerson(const Person& person,
                                                       const RgbdFrame& frame) {
  std::vector<std::optional<Eigen::Vector3d>> points;
  std::vector<double> depths;
  for (const Keypoint& joint : person.joints) {
    points.push_back(lift(joint, frame));
    if (points.back()) depths.push_back(points.back()->z());
  }
  if (depths.empty()) return points;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  for (auto& point : points) {
    if (point && std::abs(point->z() - *middle) > kReach_m) point.reset();
  }
  return points;
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
  const auto points = liftPerson(person, frame);
  for (const auto& [from, to] : pf::kSkeletonLines) {
    const auto& a = points[static_cast<std::size_t>(from)];
    const auto& b = points[static_cast<std::size_t>(to)];
    if (!a || !b || (*a - *b).norm() > kLongestBone_m) continue;
    marker.points.push_back(tf2::toMsg(*a));
    marker.points.push_back(tf2::toMsg(*b));
  }
  return marker;
}

}  // namespace

visualization_msgs::MarkerArray noMarkers(const std_msgs::Header& header) {
  visualization_msgs::MarkerArray markers;
  markers.markers.emplace_back();
  markers.markers.back().header = header;
  markers.markers.back().action = visualization_msgs::Marker::DELETEALL;
  return markers;
}

visualization_msgs::MarkerArray toMarkers(const People& people, const RgbdFrame& frame,
                                          const std_msgs::Header& header) {
  visualization_msgs::MarkerArray markers = noMarkers(header);
  for (std::size_t i = 0; i < people.people.size(); ++i) {
    const int id = people.people[i].id;
    const std::size_t number = id > 0 ? static_cast<std::size_t>(id) : i;  // keeps its colour
    visualization_msgs::Marker marker = markerOf(people.people[i], number, frame, header);
    if (!marker.points.empty()) markers.markers.push_back(std::move(marker));
  }
  return markers;
}

}  // namespace posefusion_ros
