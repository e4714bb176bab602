// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/replay_progress.hpp"

#include <cmath>
#include <cstdio>

namespace posefusion_ros {
namespace {

constexpr std::chrono::seconds kPeriod{5};

}  // namespace

std::string ReplayProgress::after(std::size_t sent, Time now) {
  if (now - told_ < kPeriod || sent == 0) return {};
  told_ = now;
  const double rate =
      static_cast<double>(sent) / std::chrono::duration<double>(now - begin_).count();
  const std::size_t rest = total_ > sent ? total_ - sent : 0;
  const long left_s = std::lround(static_cast<double>(rest) / rate);
  char text[96];
  std::snprintf(text, sizeof text, "%zu of %zu frames sent, %.1f a second, %ld:%02ld left", sent,
                total_, rate, left_s / 60, left_s % 60);
  return text;
}

}  // namespace posefusion_ros
