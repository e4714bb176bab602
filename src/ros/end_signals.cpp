// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/end_signals.hpp"

#include <ros/init.h>

#include <signal.h>

namespace posefusion_ros {
namespace {

/// Sets a flag, as roscpp's own handler does.
void end(int /*signal*/) { ros::requestShutdown(); }

}  // namespace

void endWellOnSignals() {
  for (const int number : {SIGTERM, SIGHUP}) {
    struct sigaction now {};
    if (sigaction(number, nullptr, &now) != 0) continue;
    if ((now.sa_flags & SA_SIGINFO) != 0 || now.sa_handler != SIG_DFL) continue;
    struct sigaction ours {};
    ours.sa_handler = end;
    ours.sa_flags = SA_RESTART;
    sigaction(number, &ours, nullptr);
  }
}

}  // namespace posefusion_ros
