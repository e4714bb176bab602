// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <nodelet/nodelet.h>
#include <ros/publisher.h>
#include <std_msgs/Header.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "posefusion_ros/bags/messages.hpp"
#include "posefusion_ros/notice.hpp"
#include "posefusion_ros/parameters.hpp"
#include "posefusion_ros/queue_keeper.hpp"
#include "posefusion_ros/stage_watch.hpp"

namespace posefusion_ros {

/// Messages between nodelets that may wait for their callback, and stamps that may wait for the
/// rest of their set: enough that nothing is lost without a word (they are pointers).
constexpr int kInternalQueue = 100;

/// What the nodelets of the chain have in common: no exception leaves them, a frame that is given
/// up is reported to fusion (which publishes one status for every frame), parameters are logged at
/// the start, and /diagnostics reports the state of the stage every `~diagnostic_period` seconds
/// (wall).
class ChainNodelet : public nodelet::Nodelet {
 public:
  ~ChainNodelet() override { diagnostics_timer_.stop(); }

 protected:
  /// Reads parameters, advertises, makes the stage, subscribes last. What it throws is logged, and
  /// the nodelet stays idle, or ends the process where `~end_on_error` says that it is ours alone.
  virtual void start() = 0;

  /// Gives a frame up. The reason is logged (throttled) where `outcome` is worth a warning.
  void reject(const std_msgs::Header& header, std::uint8_t outcome, const std::string& reason);

  /// Calls `work` for the frame of `header`; what it throws is logged and the frame is given up.
  void guarded(const std_msgs::Header& header, const std::function<void()>& work);

  /// A frame is done with and passed on.
  void passed(const ros::Time& stamp);

  /// For the stage that hears of every frame, in place of passed(): one that was not fused counts
  /// as given up, by whichever stage. From the first call on reject() does not count.
  void noteOutcome(const ros::Time& stamp, std::uint8_t outcome);

  /// For what the stage itself reports.
  StageWatch& watch() { return watch_; }

  /// Logs the parameters that are not the defaults, and warns of unknown ones.
  void report(const Parameters& parameters);

  /// Logs them.
  void tell(const std::vector<Notice>& notices) const;

  /// Calls `action` once `ready` is true: looks every 50 ms, in the nodelet's serial queue. A stage
  /// advertises its results only when the stage before it is there, so that once `status` is
  /// advertised the whole chain is connected.
  void whenReady(std::function<bool()> ready, std::function<void()> action);

  /// Ends whenReady() and waits for it if it is at work. To be called first in the destructor of
  /// each nodelet that uses it.
  void stopWaiting() { ready_timer_.stop(); }

 private:
  void onInit() final;
  void startDiagnostics();

  QueueKeeper queues_;
  std::atomic<bool> hears_all_{false};
  StageWatch watch_{std::chrono::steady_clock::now()};
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  ros::WallTimer diagnostics_timer_;
  ros::Publisher rejected_;
  ros::WallTimer ready_timer_;
};

}  // namespace posefusion_ros
