// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace posefusion_ros {

/// Says which frames of a stream may be used by their stamps: they rise, and not much faster than
/// the time in which they come. A jump is believed when a second frame goes on from the first: one
/// wrong stamp costs one frame, and a clock that was put right is followed. Not thread safe.
class StampGuard {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// `jump_s`: what stamps may go back, or on ahead of the time that passes, and be no jump.
  explicit StampGuard(double jump_s) : jump_s_(jump_s) {}

  /// Why a frame of this stamp that comes now is not to be used; empty: it is.
  std::string defectOf(std::int64_t stamp_ns, Time now);

 private:
  struct Arrival {
    std::int64_t stamp_ns = 0;
    Time time;
  };

  bool follows(const Arrival& last, const Arrival& next) const;

  double jump_s_;
  std::optional<Arrival> last_;  ///< that was used
  std::optional<Arrival> jump_;  ///< that was not: the next one decides
};

/// Lets at most so many frames a second pass, evenly, by their stamps. Not thread safe.
class RateLimit {
 public:
  explicit RateLimit(double rate_hz) : period_ns_(static_cast<std::int64_t>(1e9 / rate_hz)) {}

  bool lets(std::int64_t stamp_ns);

 private:
  std::int64_t period_ns_;
  std::optional<std::int64_t> due_ns_;
};

}  // namespace posefusion_ros
