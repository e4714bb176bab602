// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <tf2_msgs/TFMessage.h>

#include <chrono>
#include <map>
#include <mutex>
#include <string>

namespace posefusion_ros {

/// Whether another node sends a frame's transform already. A frame has one parent: with two,
/// everything below it jumps between them. Thread safe.
class ParentWatch {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// A transform of `child` was heard.
  void hear(const std::string& child, const std::string& parent, const std::string& publisher,
            bool is_static, Time now);

  /// Names the node that sends the transform of `child`, unless it is `publisher` with this
  /// `parent` or silent for two seconds; empty otherwise.
  std::string conflict(const std::string& child, const std::string& parent,
                       const std::string& publisher, Time now) const;

  /// The frame above `child` without a parent; `publisher` with this `parent` does not count.
  std::string rootAbove(const std::string& child, const std::string& parent,
                        const std::string& publisher) const;

 private:
  struct Heard {
    Time when;
    bool is_static = false;  // said once, and holds
  };
  using Sender = std::pair<std::string, std::string>;  // parent, publisher

  mutable std::mutex mutex_;
  std::map<std::string, std::map<Sender, Heard>> heard_;
};

/// A ParentWatch that hears /tf and /tf_static.
class ListeningParentWatch {
 public:
  explicit ListeningParentWatch(ros::NodeHandle& handle);

  /// See ParentWatch; for transforms that this process sends.
  std::string conflict(const std::string& child, const std::string& parent) const;

  /// What the user may set where there is one.
  std::string advice(const std::string& child, const std::string& map_frame) const;

 private:
  using Event = ros::MessageEvent<tf2_msgs::TFMessage const>;

  void listen(const Event& event, bool is_static);

  ParentWatch watch_;
  ros::Subscriber moving_, fixed_;
};

}  // namespace posefusion_ros
