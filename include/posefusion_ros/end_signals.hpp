// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace posefusion_ros {

/// roscpp ends well by Ctrl-C (SIGINT) alone. From now on SIGTERM (kill, a service that is stopped,
/// roslaunch after 15 s) and SIGHUP (the terminal closes) do the same, so that maps are saved; a
/// second one does not cut that short. What the program has set for a signal stays.
void endWellOnSignals();

}  // namespace posefusion_ros
