// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nodelet/nodelet.h>
#include <ros/publisher.h>
#include <std_msgs/Header.h>

#include <functional>
#include <string>

#include "posefusion_ros/messages.hpp"
#include "posefusion_ros/parameters.hpp"
#include "posefusion_ros/queue_keeper.hpp"

namespace posefusion_ros {

/// Messages between nodelets that may wait for their callback, and stamps that may wait for the
/// rest of their set: enough that nothing is lost without a word (they are pointers).
constexpr int kInternalQueue = 100;

/// What the nodelets of the chain have in common: no exception leaves them, a frame that is given
/// up is told to fusion (which reports one status for every frame), parameters are reported at the
/// start.
class ChainNodelet : public nodelet::Nodelet {
 protected:
  /// Reads parameters, advertises, makes the stage, subscribes last. What it throws is logged, and
  /// the nodelet stays idle, or ends the process where `~end_on_error` says that it is ours alone.
  virtual void start() = 0;

  /// Gives a frame up. The reason is logged (throttled) where `outcome` is worth a warning.
  void reject(const std_msgs::Header& header, std::uint8_t outcome, const std::string& reason);

  /// Calls `work` for the frame of `header`; what it throws is logged and the frame is given up.
  void guarded(const std_msgs::Header& header, const std::function<void()>& work);

  /// Logs the parameters that are not the defaults, and warns of those that nobody knows.
  void report(const Parameters& parameters);

  /// Calls `action` once `ready` is true: looks every 50 ms, in the nodelet's serial queue. A stage
  /// advertises its results only when the stage before it is there, so that once `status` is
  /// advertised the whole chain is connected.
  void whenReady(std::function<bool()> ready, std::function<void()> action);

  /// Ends whenReady() and waits for it if it is at work. To be called first in the destructor of
  /// each nodelet that uses it.
  void stopWaiting() { ready_timer_.stop(); }

 private:
  void onInit() final;

  QueueKeeper queues_;
  ros::Publisher rejected_;
  ros::WallTimer ready_timer_;
};

}  // namespace posefusion_ros
