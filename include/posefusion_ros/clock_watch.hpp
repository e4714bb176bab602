// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <chrono>
#include <string>

namespace posefusion_ros {

/// Says in plain words, with what to do, where the stamp of an image that comes now is of another
/// clock than ROS time; empty where they agree. They do not where they differ by more than 60 s: no
/// frame waits so long in the chain, and clocks of the machines of one robot do not differ so much,
/// but a recording is older. `simulated`: ROS time is that of /clock; `now` is 0 before it comes.
std::string clockDefect(const ros::Time& stamp, const ros::Time& now, bool simulated);

/// What is said again and again is said after pauses that grow: 5 s, 10 s, 20 s, ... 5 min.
class GrowingPause {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Whether to log it now. `what` names the case: a different one is logged at once. Empty:
  /// nothing to log, and the next case is new.
  bool isDue(Time now, const std::string& what);

 private:
  std::string what_;
  Time said_{};
  std::chrono::seconds pause_{0};
};

}  // namespace posefusion_ros
