// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/loop_messages.hpp"

#include <ros/exception.h>
#include <ros/time.h>

#include <algorithm>
#include <mutex>

#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/bags/stage_messages.hpp"

namespace posefusion_ros {

std::uint8_t wantedBy(const pf::LoopQuestion& question) {
  const int loops = question.keyframe ? KeyframeMsg::LOOPS : 0;
  const int place = question.place ? KeyframeMsg::PLACE : 0;
  return static_cast<std::uint8_t>(loops + place);
}

KeyframeMsg toWire(const LoopQuestionMessage& message) {
  const pf::LoopQuestion& question = message.question;
  KeyframeMsg wire;
  wire.header = message.header;
  wire.number = message.number;
  wire.wanted = wantedBy(question);
  for (const pf::MapPose& pose : question.corrected) {
    wire.corrected.push_back(toPose(pose.T_map_camera));
    wire.corrected_fragments.push_back(static_cast<std::uint32_t>(pose.fragment));
  }
  wire.retired.assign(question.retired.begin(), question.retired.end());
  wire.known = question.known ? static_cast<std::uint32_t>(question.known->size()) : 0;
  pf::MapPose pose;
  if (question.place) pose = question.place->last;
  if (question.keyframe) pose = question.keyframe->pose;
  wire.fragment = static_cast<std::uint32_t>(pose.fragment);
  wire.pose = toPose(pose.T_map_camera);
  if (!question.keyframe) return wire;
  const pf::KeyframeView& view = *question.keyframe;
  wire.keyframe = static_cast<std::uint32_t>(view.id);
  wire.intensity = *toImage(view.intensity, "mono8", message.header);
  wire.depth = *toImage(view.depth_mm, "16UC1", message.header);
  wire.camera = toCameraInfo(view.camera, message.header);
  wire.nobody_in_view = static_cast<unsigned char>(view.nobody_in_view);
  return wire;
}

LoopConstraintMsg toWire(const LoopAnswerMessage& message) {
  const pf::LoopAnswer& answer = message.answer;
  LoopConstraintMsg wire;
  wire.header = message.header;
  wire.number = message.number;
  wire.wanted = message.wanted;
  wire.to = message.keyframe;
  for (const pf::LoopConstraint& loop : answer.loops) {
    wire.from.push_back(static_cast<std::uint32_t>(loop.from));
    geometry_msgs::PoseWithCovariance pose;
    pose.pose = toPose(loop.T_from_to);
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(pose.covariance.data()) =
        loop.covariance;
    wire.pose.push_back(pose);
  }
  wire.found = static_cast<unsigned char>(answer.place.has_value());
  const pf::MapPose place = answer.place ? answer.place->pose() : pf::MapPose();
  wire.fragment = static_cast<std::uint32_t>(place.fragment);
  wire.place = toPose(place.T_map_camera);
  wire.error = message.error;
  wire.keyframes = answer.counts.keyframes;
  wire.ferns = answer.counts.ferns;
  wire.compared = answer.counts.compared;
  wire.accepted = answer.counts.accepted;
  wire.local = answer.counts.local;
  wire.searched = answer.counts.searched;
  wire.places = answer.counts.found;
  return wire;
}

std::uint64_t newIdentity() {
  // The library may be unloaded in between: a counter would begin again.
  static std::uint64_t last = 0;
  static std::mutex mutex;
  const std::lock_guard<std::mutex> lock(mutex);
  last = std::max(last + 1, ros::WallTime::now().toNSec());
  return last;
}

void refuseFromWire() {
  throw ros::Exception(
      "questions and answers of loop closing pass by pointer: posefusion/loop_closer and "
      "posefusion/fusion have to run in one manager");
}

}  // namespace posefusion_ros
