// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/parent_watch.hpp"

#include <ros/this_node.h>

#include "posefusion_ros/transforms.hpp"

namespace posefusion_ros {
namespace {

constexpr std::chrono::seconds kSilent(2);
constexpr int kQueue = 100;

}  // namespace

void ParentWatch::hear(const std::string& child, const std::string& parent,
                       const std::string& publisher, bool is_static, Time now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  heard_[child][{parent, publisher}] = {now, is_static};
}

std::string ParentWatch::conflict(const std::string& child, const std::string& parent,
                                  const std::string& publisher, Time now) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto senders = heard_.find(child);
  if (senders == heard_.end()) return {};
  for (const auto& [sender, heard] : senders->second) {
    if (sender == Sender{parent, publisher}) continue;
    if (!heard.is_static && now - heard.when > kSilent) continue;
    return "frame " + child + " has the parent " + sender.first + " already, sent by " +
           sender.second;
  }
  return {};
}

ListeningParentWatch::ListeningParentWatch(ros::NodeHandle& handle)
    : moving_(handle.subscribe<tf2_msgs::TFMessage>(
          "/tf", kQueue,
          boost::function<void(const Event&)>([this](const Event& e) { listen(e, false); }))),
      fixed_(handle.subscribe<tf2_msgs::TFMessage>(
          "/tf_static", kQueue,
          boost::function<void(const Event&)>([this](const Event& e) { listen(e, true); }))) {}

void ListeningParentWatch::listen(const Event& event, bool is_static) {
  const auto now = std::chrono::steady_clock::now();
  for (const auto& transform : event.getConstMessage()->transforms) {
    watch_.hear(plainFrame(transform.child_frame_id), plainFrame(transform.header.frame_id),
                event.getPublisherName(), is_static, now);
  }
}

std::string ListeningParentWatch::conflict(const std::string& child,
                                           const std::string& parent) const {
  return watch_.conflict(child, parent, ros::this_node::getName(),
                         std::chrono::steady_clock::now());
}

}  // namespace posefusion_ros
