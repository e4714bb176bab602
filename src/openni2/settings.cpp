// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_openni2/settings.hpp"

#include <cstdio>

#include "posefusion/core/error.hpp"

namespace pf::openni2 {

std::string toText(const StreamMode& mode) {
  return std::to_string(mode.width) + "x" + std::to_string(mode.height) + "@" +
         std::to_string(mode.fps);
}

StreamMode parseMode(const std::string& text) {
  StreamMode mode;
  int used = 0;
  const int fields =
      std::sscanf(text.c_str(), "%5dx%5d@%4d%n", &mode.width, &mode.height, &mode.fps, &used);
  const bool whole = fields == 3 && static_cast<std::size_t>(used) == text.size();
  if (!whole || mode.width <= 0 || mode.height <= 0 || mode.fps <= 0) {
    throw InputError("stream mode is '" + text + "', expected WIDTHxHEIGHT@RATE, like 640x480@30");
  }
  return mode;
}

}  // namespace pf::openni2
