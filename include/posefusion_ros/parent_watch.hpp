// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <tf2_msgs/TFMessage.h>

#include <chrono>
#include <map>
#include <mutex>
#include <string>

namespace posefusion_ros {

/// Tells whether somebody else sends a frame's transform already. A frame has one parent: with two,
/// everything below it jumps between them. Thread safe.
class ParentWatch {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// A transform of `child` was heard.
  void hear(const std::string& child, const std::string& parent, const std::string& publisher,
            bool is_static, Time now);

  /// Says who sends the transform of `child`, where that is neither `publisher` with this `parent`
  /// nor silent for two seconds; empty otherwise.
  std::string conflict(const std::string& child, const std::string& parent,
                       const std::string& publisher, Time now) const;

  /// The frame above `child` that nobody gives a parent, besides `publisher` this `parent`.
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
