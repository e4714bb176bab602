// SPDX-License-Identifier: BSD-3-Clause
#include "transform_hold.hpp"

#include <utility>

#include "posefusion_ros/clock_watch.hpp"

namespace posefusion_ros {
namespace {

constexpr double kPeriod_s = 0.2;

}  // namespace

TransformHold::TransformHold(ros::NodeHandle& handle, std::function<void(const ros::Time&)> hold)
    : hold_(std::move(hold)),
      timer_(handle.createWallTimer(
          ros::WallDuration(kPeriod_s),
          ros::WallTimerCallback([this](const ros::WallTimerEvent&) { look(); }))) {}

void TransformHold::heard(const ros::Time& stamp) {
  hears_frames_ = true;
  is_one_clock_ = clockDefect(stamp, ros::Time::now(), ros::Time::isSimTime()).empty();
}

void TransformHold::look() {
  if (!hears_frames_.exchange(false) && is_one_clock_) hold_(ros::Time::now());
}

}  // namespace posefusion_ros
