// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace pf {

/// How fast frames come. What is meant as a time is counted in frames by it, so that a frame that
/// comes late (the gate dropped those before) counts as one.
struct Pace {
  static constexpr double kUsual_hz = 30.0;

  double frame_s = 1.0 / kUsual_hz;

  /// Frames in so many seconds, at least one.
  int framesIn(double seconds) const;

  /// What one frame counts for where support is counted over time: in frames at 30 Hz, to the
  /// quarter. Sums of quarters are exact, and stamps that jitter do not change them.
  float worth() const;
};

/// Measures the pace: the median of the last gaps between frames.
class PaceMeter {
 public:
  /// Call for each frame. A stamp that is not later than the one before begins anew.
  Pace add(std::int64_t stamp_ns);

 private:
  // Of a burst of blur the gate lets some frames through, a few long gaps among many short ones.
  static constexpr std::size_t kGaps = 31;

  std::array<double, kGaps> gaps_s_{};  // of the last ones, in turns
  std::size_t count_ = 0;
  std::optional<std::int64_t> last_ns_;
};

}  // namespace pf
