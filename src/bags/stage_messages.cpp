// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/bags/stage_messages.hpp"

#include <algorithm>
#include <boost/make_shared.hpp>

#include "posefusion/core/error.hpp"
#include "posefusion/pose/person_mask.hpp"
#include "posefusion_ros/bags/conversions.hpp"

namespace posefusion_ros {

using pf::InputError;

namespace {

std::vector<std::uint8_t> bytesOf(const cv::Mat& cells) {
  return cells.empty() ? std::vector<std::uint8_t>()
                       : std::vector<std::uint8_t>(cells.reshape(1, 1));
}

/// View of the message's bytes.
cv::Mat cellsOf(const std::vector<std::uint8_t>& bytes, const char* name) {
  if (bytes.empty()) return {};
  const std::size_t cells = static_cast<std::size_t>(pf::kMaskWidth) * pf::kMaskHeight;
  if (bytes.size() != cells) {
    throw InputError("people: " + std::string(name) + " has " + std::to_string(bytes.size()) +
                     " cells, expected 80x60 or none");
  }
  return {pf::kMaskHeight, pf::kMaskWidth, CV_8UC1, const_cast<std::uint8_t*>(bytes.data())};
}

}  // namespace

PeopleMsg toMessage(const pf::People& people, const std_msgs::Header& header) {
  PeopleMsg message;
  message.header = header;
  message.detected = static_cast<unsigned char>(people.detected);
  message.mask = bytesOf(people.mask.probability);
  message.mask_owner = bytesOf(people.mask.owner);
  message.people.resize(people.people.size());
  for (std::size_t i = 0; i < people.people.size(); ++i) {
    const pf::Person& from = people.people[i];
    message.people[i].score = from.score;
    message.people[i].id = from.id;
    for (int j = 0; j < pf::kJointCount; ++j) {
      KeypointMsg& joint = message.people[i].joints[j];
      joint.u = from.joints[j].u;
      joint.v = from.joints[j].v;
      joint.p = from.joints[j].p;
    }
  }
  return message;
}

pf::People fromMessage(const PeopleMsg& message) {
  pf::People people;
  people.stamp_ns = toNs(message.header.stamp);
  people.detected = message.detected != 0;
  people.mask = {cellsOf(message.mask, "mask"), cellsOf(message.mask_owner, "mask_owner")};
  if (people.mask.probability.size() != people.mask.owner.size()) {
    throw InputError("people: mask and mask_owner, expected both or none");
  }
  people.people.resize(message.people.size());
  for (std::size_t i = 0; i < message.people.size(); ++i) {
    people.people[i].score = message.people[i].score;
    people.people[i].id = message.people[i].id;
    for (int j = 0; j < pf::kJointCount; ++j) {
      const KeypointMsg& from = message.people[i].joints[j];
      people.people[i].joints[j] = {from.u, from.v, from.p};
    }
  }
  return people;
}

SparseFlowMsg::Ptr toMessage(const pf::SparseFlow& flow, const std_msgs::Header& header) {
  auto message = boost::make_shared<SparseFlowMsg>();
  message->header = header;
  message->from = toTime(flow.from_ns);
  message->before.reserve(2 * flow.before.size());
  message->after.reserve(2 * flow.after.size());
  for (const cv::Point2f& p : flow.before) {
    message->before.insert(message->before.end(), {p.x, p.y});
  }
  for (const cv::Point2f& p : flow.after) message->after.insert(message->after.end(), {p.x, p.y});
  message->ids = flow.ids;
  return message;
}

pf::SparseFlow fromMessage(const SparseFlowMsg& message) {
  if (message.before.size() != message.after.size() || message.before.size() % 2 != 0) {
    throw InputError("flow: " + std::to_string(message.before.size()) + " numbers before and " +
                     std::to_string(message.after.size()) + " after, expected equally many pairs");
  }
  if (2 * message.ids.size() != message.before.size()) {
    throw InputError("flow: " + std::to_string(message.ids.size()) + " ids for " +
                     std::to_string(message.before.size() / 2) + " corners");
  }
  pf::SparseFlow flow;
  flow.ids = message.ids;
  flow.from_ns = toNs(message.from);
  flow.to_ns = toNs(message.header.stamp);
  for (std::size_t i = 0; i < message.before.size(); i += 2) {
    flow.before.emplace_back(message.before[i], message.before[i + 1]);
    flow.after.emplace_back(message.after[i], message.after[i + 1]);
  }
  return flow;
}

TrackingStatusMsg toMessage(const pf::FrameStatus& status, const std_msgs::Header& header,
                            const Eigen::Isometry3d& T_map_camera) {
  TrackingStatusMsg message;
  message.header = header;
  message.outcome = static_cast<std::uint8_t>(status.outcome);
  message.state = static_cast<std::uint8_t>(status.state);
  message.located = static_cast<unsigned char>(status.located);
  message.reason = reasonOf(status);
  message.pose = toPose(T_map_camera);
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(message.covariance.data()) =
      status.covariance;
  const pf::TrackingResult& tracking = status.tracking;
  message.candidates = static_cast<std::uint32_t>(std::max(0, tracking.candidates));
  message.inliers = static_cast<std::uint32_t>(std::max(0, tracking.inliers));
  message.geometric_rmse_m = tracking.geometric_rmse_m;
  message.photometric_rmse = tracking.photometric_rmse;
  message.surfels = status.surfels;
  message.map_version = static_cast<std::uint32_t>(status.map_version);
  message.fragment = static_cast<std::uint32_t>(status.fragment);
  message.tracking_ms = status.tracking_ms;
  message.fusion_ms = status.fusion_ms;
  return message;
}

pf::FrameStatus fromMessage(const TrackingStatusMsg& message) {
  pf::FrameStatus status;
  status.stamp_ns = toNs(message.header.stamp);
  status.outcome = static_cast<pf::FrameOutcome>(message.outcome);
  status.state = static_cast<pf::TrackingState>(message.state);
  status.located = message.located != 0;
  status.surfels = message.surfels;
  status.tracking_ms = message.tracking_ms;
  status.fusion_ms = message.fusion_ms;
  const geometry_msgs::Pose& pose = message.pose;
  const auto& q = pose.orientation;
  status.T_map_camera.linear() =
      Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  status.T_map_camera.translation() << pose.position.x, pose.position.y, pose.position.z;
  return status;
}

std::string outcomeName(std::uint8_t outcome) {
  if (outcome == TrackingStatusMsg::DROPPED) return "dropped";
  if (outcome == TrackingStatusMsg::NO_DETECTOR) return "no_detector";
  if (outcome == TrackingStatusMsg::PAUSED) return "paused";
  return std::string(pf::name(static_cast<pf::FrameOutcome>(outcome)));
}

geometry_msgs::Pose toPose(const Eigen::Isometry3d& T) {
  const Eigen::Quaterniond q(T.linear());
  geometry_msgs::Pose pose;
  pose.position.x = T.translation().x();
  pose.position.y = T.translation().y();
  pose.position.z = T.translation().z();
  pose.orientation.x = q.x();
  pose.orientation.y = q.y();
  pose.orientation.z = q.z();
  pose.orientation.w = q.w();
  return pose;
}

}  // namespace posefusion_ros
