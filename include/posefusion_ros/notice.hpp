// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace posefusion_ros {

/// A line for the log, from code that does not write to the log itself.
struct Notice {
  bool is_warning = false;
  std::string text;
};

}  // namespace posefusion_ros
