// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/names.h>

#include <chrono>
#include <string>
#include <utility>

#include "posefusion_ros/node_control.hpp"

namespace posefusion_ros {

/// Whether the process of the chain runs; it is looked for now and then. Not thread safe.
class ChainPresence {
 public:
  /// `manager`: its node; empty: it is taken for granted.
  explicit ChainPresence(std::string manager) : manager_(std::move(manager)) {}

  /// True for some seconds at the beginning, until it is there.
  bool isUp() {
    const auto now = Clock::now();
    if (manager_.empty() || now < look_again_) return is_up_;
    look_again_ = now + std::chrono::milliseconds(500);
    const bool is_there = isNodeUp(ros::names::resolve(manager_));
    was_there_ = was_there_ || is_there;
    is_up_ = is_there || (!was_there_ && now < begin_ + kPatience);
    return is_up_;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kPatience{15};

  std::string manager_;
  Clock::time_point begin_ = Clock::now(), look_again_ = begin_;
  bool was_there_ = false, is_up_ = true;
};

}  // namespace posefusion_ros
