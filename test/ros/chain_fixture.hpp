// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <nodelet/loader.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <boost/make_shared.hpp>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <sstream>
#include <string>
#include <vector>

#include "../simulated_sequence.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/bags/stage_messages.hpp"
#include "posefusion_ros/names.hpp"

namespace posefusion_ros {

/// Three messages of the camera.
struct CameraMessages {
  sensor_msgs::ImagePtr color, depth;
  sensor_msgs::CameraInfoPtr info;
};

inline CameraMessages toMessages(const pf::RgbdFrame& frame) {
  std_msgs::Header header;
  header.stamp = toTime(frame.stamp_ns);
  header.frame_id = frames::kOptical;
  return {toImage(frame.color, "rgb8", header), toDepthImage(frame, header),
          boost::make_shared<sensor_msgs::CameraInfo>(toCameraInfo(frame.camera, header))};
}

/// Copies with another stamp.
inline CameraMessages restamped(const CameraMessages& messages, std::int64_t stamp_ns) {
  CameraMessages copy = {boost::make_shared<sensor_msgs::Image>(*messages.color),
                         boost::make_shared<sensor_msgs::Image>(*messages.depth),
                         boost::make_shared<sensor_msgs::CameraInfo>(*messages.info)};
  copy.color->header.stamp = copy.depth->header.stamp = copy.info->header.stamp = toTime(stamp_ns);
  return copy;
}

/// An empty room, drawn once for all tests of the program.
inline const pf::SimulatedSequence& emptyRoom() {
  static const pf::SimulatedSequence drawn("empty_box", 40);
  return drawn;
}

inline int outcome(const TrackingStatusMsg& status) { return status.outcome; }

/// The poses of a trajectory.txt, without comments.
inline std::string posesIn(const std::string& file) {
  std::istringstream lines(pf::readFile(file));
  std::string line, poses;
  while (std::getline(lines, line)) {
    if (line.rfind('#', 0) != 0) poses += line + "\n";
  }
  return poses;
}

/// The five nodelets in this process, in a namespace of their own, and a camera that feeds them.
class Chain {
 public:
  static const std::vector<std::string>& nodelets() {
    static const std::vector<std::string> names = {"blur_gate", "pose_detector", "segmenter",
                                                   "loop_closer", "fusion"};
    return names;
  }

  /// Sets a private parameter of all; before load().
  template <typename Value>
  void set(const std::string& name, const Value& value) {
    for (const auto& nodelet : nodelets())
      ros::param::set(space_ + "/" + nodelet + "/" + name, value);
  }

  explicit Chain(const std::string& space) : space_("/" + space), handle_(space_) {
    set("lossless", true);
    set("pose/detector", std::string("none"));
    color_ = handle_.advertise<sensor_msgs::Image>(topics::kColor, 1000);
    depth_ = handle_.advertise<sensor_msgs::Image>(topics::kDepth, 1000);
    info_ = handle_.advertise<sensor_msgs::CameraInfo>(topics::kCameraInfo, 1000);
    status_ = handle_.subscribe(topics::kStatus, 1000, &Chain::onStatus, this);
  }

  /// Loads the chain; true once it reports.
  bool load() { return load(nodelets()) && isUp(); }
  /// The chain without the loop closer.
  bool loadWithoutCloser() {
    return load({"blur_gate", "pose_detector", "segmenter", "fusion"}) && isUp();
  }
  bool isUp() {
    return waitUntil([this] { return isReporting() && color_.getNumSubscribers() > 0; });
  }
  bool isReporting() const { return status_.getNumPublishers() > 0; }
  bool load(const std::vector<std::string>& names) {
    for (const auto& nodelet : names) {
      if (!loader_->load(space_ + "/" + nodelet, "posefusion/" + nodelet, {}, {})) return false;
    }
    return true;
  }
  /// Returns when they are gone.
  void unload() { loader_ = std::make_unique<nodelet::Loader>(false); }
  /// Returns before it is gone where a thread is in one of its callbacks.
  void unload(const std::string& nodelet) { loader_->unload(space_ + "/" + nodelet); }
  /// Waits until the services of fusion are gone.
  bool hasLostFusion() const {
    return waitUntil([this] { return !ros::service::exists(space_ + "/fusion/reset", false); });
  }

  void send(const CameraMessages& m) {
    if (m.info) info_.publish(sensor_msgs::CameraInfoConstPtr(m.info));
    if (m.depth) depth_.publish(sensor_msgs::ImageConstPtr(m.depth));
    if (m.color) color_.publish(sensor_msgs::ImageConstPtr(m.color));
  }

  /// Sends a frame and waits for its status.
  TrackingStatusMsg process(const CameraMessages& m) {
    const std::size_t before = statuses().size();
    send(m);
    if (!waitForStatuses(before + 1)) return TrackingStatusMsg();
    return statuses().back();
  }

  bool waitForStatuses(std::size_t count) {
    return waitUntil([&] { return statuses().size() >= count; });
  }

  std::vector<TrackingStatusMsg> statuses() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return statuses_;
  }

  /// Calls a service of fusion whose request is one string, `field`.
  template <typename Service>
  typename Service::Response call(const std::string& service, std::string Service::Request::*field,
                                  const std::string& value) {
    Service call;
    call.request.*field = value;
    EXPECT_TRUE(ros::service::call(space_ + "/fusion/" + service, call));
    return call.response;
  }
  std_srvs::TriggerResponse call(const std::string& service) {
    std_srvs::Trigger trigger;
    EXPECT_TRUE(ros::service::call(space_ + "/fusion/" + service, trigger));
    return trigger.response;
  }

  ros::NodeHandle& handle() { return handle_; }
  const std::string& space() const { return space_; }

  template <typename Condition>
  static bool waitUntil(const Condition& condition, double patience_s = 30) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(patience_s);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      ros::WallDuration(0.002).sleep();
    }
    return true;
  }

 private:
  void onStatus(const TrackingStatusMsg::ConstPtr& status) {
    const std::lock_guard<std::mutex> lock(mutex_);
    statuses_.push_back(*status);
  }

  std::string space_;
  ros::NodeHandle handle_;
  mutable std::mutex mutex_;
  std::vector<TrackingStatusMsg> statuses_;
  ros::Publisher color_, depth_, info_;
  ros::Subscriber status_;
  std::unique_ptr<nodelet::Loader> loader_ = std::make_unique<nodelet::Loader>(false);
};

}  // namespace posefusion_ros
