// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/chain_nodelet.hpp"

#include <ros/init.h>

#include <boost/make_shared.hpp>
#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion_ros/names.hpp"

namespace posefusion_ros {
namespace {

constexpr int kRejectedQueue = 1000;
constexpr double kReadyPeriod_s = 0.05;
constexpr double kThrottle_s = 5.0;

}  // namespace

void ChainNodelet::onInit() {
  // An exception that leaves onInit() is a use after free in nodelet 1.10.
  try {
    queues_.keep(getNodeHandle());
    queues_.keep(getMTNodeHandle());
    rejected_ = getNodeHandle().advertise<TrackingStatusMsg>(topics::kRejected, kRejectedQueue);
    start();
  } catch (const std::exception& error) {
    bool end = false;
    getPrivateNodeHandle().param(kEndOnError, end, false);
    NODELET_FATAL("%s: %s", end ? "cannot start" : "stays idle", error.what());
    // The manager is that of the launch file alone where this is set.
    if (end) ros::requestShutdown();
  }
}

void ChainNodelet::reject(const std_msgs::Header& header, std::uint8_t outcome,
                          const std::string& reason) {
  if (outcome != TrackingStatusMsg::BLURRED) {
    NODELET_WARN_THROTTLE(kThrottle_s, "frame %u.%09u not used: %s", header.stamp.sec,
                          header.stamp.nsec, reason.c_str());
  }
  const auto status = boost::make_shared<TrackingStatusMsg>();
  status->header = header;
  status->outcome = outcome;
  status->reason = reason;
  rejected_.publish(TrackingStatusMsg::ConstPtr(status));
}

void ChainNodelet::guarded(const std_msgs::Header& header, const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {
    reject(header, TrackingStatusMsg::BAD_INPUT, error.what());
  }
}

void ChainNodelet::report(const Parameters& parameters) {
  NODELET_INFO("%s", parameters.changed().c_str());
  NODELET_DEBUG("%s", parameters.effective().c_str());
  for (const std::string& name : parameters.unknown()) {
    NODELET_WARN("unknown parameter %s: it has no effect", name.c_str());
  }
}

void ChainNodelet::whenReady(std::function<bool()> ready, std::function<void()> action) {
  const auto look = [this, ready = std::move(ready),
                     action = std::move(action)](const ros::WallTimerEvent&) {
    if (!ready()) return;
    ready_timer_.stop();
    action();
  };
  ready_timer_ = getNodeHandle().createWallTimer(ros::WallDuration(kReadyPeriod_s),
                                                 ros::WallTimerCallback(look));
}

}  // namespace posefusion_ros
