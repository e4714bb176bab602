// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/clock_watch.hpp"

#include <algorithm>
#include <cmath>

namespace posefusion_ros {
namespace {

constexpr double kOtherClock_s = 60;
constexpr std::chrono::seconds kFirstPause{5}, kLongestPause{300};

}  // namespace

std::string clockDefect(const ros::Time& stamp, const ros::Time& now, bool simulated) {
  if (simulated && now.isZero()) {
    return "use_sim_time is true, and no /clock has come: play the bag with --clock, or, with a "
           "live camera, call `rosparam set use_sim_time false` and start again";
  }
  // Not by ros::Duration: it throws beyond 68 years.
  const double behind_s = now.toSec() - stamp.toSec();
  if (std::abs(behind_s) <= kOtherClock_s) return {};
  const std::string apart = "the stamps of the images are " +
                            std::to_string(std::llround(std::abs(behind_s))) + " s " +
                            (behind_s > 0 ? "behind" : "ahead of");
  if (simulated) return apart + " /clock: are they of the bag that the clock is of?";
  return apart +
         " ROS time: where a bag is played, call `rosparam set use_sim_time true` before this is "
         "started and play it with --clock; where a camera is live, its clock is wrong";
}

bool GrowingPause::isDue(Time now, const std::string& what) {
  if (what != what_) {
    what_ = what;
    pause_ = std::chrono::seconds(0);
  }
  if (what.empty() || (pause_.count() > 0 && now - said_ < pause_)) return false;
  said_ = now;
  pause_ = pause_.count() == 0 ? kFirstPause : std::min(2 * pause_, kLongestPause);
  return true;
}

}  // namespace posefusion_ros
