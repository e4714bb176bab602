// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/parent_watch.hpp"

#include <ros/this_node.h>

#include <algorithm>

#include "posefusion_ros/transforms.hpp"

namespace posefusion_ros {
namespace {

constexpr std::chrono::seconds kSilent(2);
constexpr int kTransformQueue = 100;

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

std::string ParentWatch::rootAbove(const std::string& child, const std::string& parent,
                                   const std::string& publisher) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::string root = child;
  // Senders that contradict each other may make a ring.
  for (std::size_t steps = 0; steps < heard_.size(); ++steps) {
    const auto senders = heard_.find(root);
    if (senders == heard_.end()) break;
    const auto other =
        std::find_if(senders->second.begin(), senders->second.end(), [&](const auto& each) {
          return each.first != Sender{parent, publisher};
        });
    if (other == senders->second.end()) break;
    root = other->first.first;
  }
  return root;
}

ListeningParentWatch::ListeningParentWatch(ros::NodeHandle& handle)
    : moving_(handle.subscribe<tf2_msgs::TFMessage>(
          "/tf", kTransformQueue,
          boost::function<void(const Event&)>([this](const Event& e) { listen(e, false); }))),
      fixed_(handle.subscribe<tf2_msgs::TFMessage>(
          "/tf_static", kTransformQueue,
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

std::string ListeningParentWatch::advice(const std::string& child,
                                         const std::string& map_frame) const {
  const std::string root = watch_.rootAbove(child, map_frame, ros::this_node::getName());
  if (root == map_frame) {
    return "another node locates it in " + map_frame + ": give publish_tf:=false";
  }
  return "give base_frame:=" + root + " where that is the body that carries the camera, " +
         "another frame_id of the images where it is a second chain's, or publish_tf:=false";
}

}  // namespace posefusion_ros
