// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/chain_nodelet.hpp"

#include <ros/init.h>

#include <boost/make_shared.hpp>
#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion_ros/clock_watch.hpp"
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
    startDiagnostics();
    start();
  } catch (const std::exception& error) {
    bool end = false;
    getPrivateNodeHandle().param(kEndOnError, end, false);
    watch_.tell(diagnostic_msgs::DiagnosticStatus::ERROR, error.what());
    NODELET_FATAL("%s: %s", end ? "cannot start" : "stays idle", error.what());
    // The manager is that of the launch file alone where this is set.
    if (end) ros::requestShutdown();
  }
}

void ChainNodelet::startDiagnostics() {
  ros::NodeHandle& own = getPrivateNodeHandle();
  double period_s = 1.0;
  own.param(kDiagnosticPeriod, period_s, period_s);
  if (!(period_s >= 0.01)) {
    throw pf::InputError("parameter " + own.resolveName(kDiagnosticPeriod) + " is " +
                         std::to_string(period_s) + ", expected at least 0.01 s");
  }
  diagnostics_ = std::make_unique<diagnostic_updater::Updater>(getNodeHandle(), own, getName());
  diagnostics_->setHardwareID("none");
  diagnostics_->add("frames", [this](diagnostic_updater::DiagnosticStatusWrapper& out) {
    watch_.report(std::chrono::steady_clock::now(), out);
  });
  // A multi-threaded queue: the serial one may be held up, which is what should be reported.
  diagnostics_timer_ = getMTNodeHandle().createWallTimer(
      ros::WallDuration(period_s),
      ros::WallTimerCallback([this](const ros::WallTimerEvent&) { diagnostics_->force_update(); }));
}

void ChainNodelet::passed(const ros::Time& stamp) {
  const ros::Time now = ros::Time::now();
  watch_.tellClock(clockDefect(stamp, now, ros::Time::isSimTime()));
  watch_.passed(std::chrono::steady_clock::now(), now.toSec() - stamp.toSec());
}

void ChainNodelet::noteOutcome(const ros::Time& stamp, std::uint8_t outcome) {
  hears_all_ = true;
  if (outcome == TrackingStatusMsg::FUSED || outcome == TrackingStatusMsg::LOCATED) {
    return passed(stamp);
  }
  watch_.givenUp(std::chrono::steady_clock::now(), outcome);
}

void ChainNodelet::reject(const std_msgs::Header& header, std::uint8_t outcome,
                          const std::string& reason) {
  if (outcome != TrackingStatusMsg::BLURRED) {
    NODELET_WARN_THROTTLE(kThrottle_s, "frame %u.%09u not used: %s", header.stamp.sec,
                          header.stamp.nsec, reason.c_str());
  }
  if (!hears_all_) watch_.givenUp(std::chrono::steady_clock::now(), outcome);
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

void ChainNodelet::tell(const std::vector<Notice>& notices) const {
  for (const Notice& notice : notices) {
    if (notice.is_warning) {
      NODELET_WARN("%s", notice.text.c_str());
    } else {
      NODELET_INFO("%s", notice.text.c_str());
    }
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
