// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

#include "posefusion_ros/bags/messages.hpp"

namespace posefusion_ros {

/// The newest model view, handed from a ROS callback to the segmenter's thread.
class Background {
 public:
  void set(const ModelViewMsg::ConstPtr& view) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      view_ = view;
      if (view->reset) ++resets_;
    }
    changed_.notify_all();
  }

  /// The newest view, or null.
  ModelViewMsg::ConstPtr newest() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return view_;
  }

  /// Waits until the newest view is that of the frame of this stamp; false at a time-out or after
  /// stop().
  bool waitFor(const ros::Time& stamp, std::chrono::milliseconds timeout) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_for(lock, timeout, [&] { return stopped_ || isOf(stamp); });
    return !stopped_ && isOf(stamp);
  }

  /// Ends all waiting, for good.
  void stop() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stopped_ = true;
    }
    changed_.notify_all();
  }
  bool stopped() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return stopped_;
  }

  /// How often the map was emptied since the last call.
  int takeResets() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(resets_, 0);
  }

 private:
  bool isOf(const ros::Time& stamp) const { return view_ && view_->header.stamp == stamp; }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  ModelViewMsg::ConstPtr view_;
  int resets_ = 0;
  bool stopped_ = false;
};

}  // namespace posefusion_ros
