// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/pace.hpp"

#include <algorithm>
#include <cmath>

namespace pf {
namespace {

// A longer gap is a pause, which does not count for the pace.
constexpr double kLongestGap_s = 1.0;
constexpr double kMostFrames = 1e9;
constexpr double kParts = 4.0;  // of the worth of a frame at 30 Hz

}  // namespace

int Pace::framesIn(double seconds) const {
  return static_cast<int>(std::clamp(std::round(seconds / frame_s), 1.0, kMostFrames));
}

float Pace::worth() const {
  return static_cast<float>(std::max(1.0, std::round(kUsual_hz * frame_s * kParts)) / kParts);
}

Pace PaceMeter::add(std::int64_t stamp_ns) {
  const double gap_s = last_ns_ ? 1e-9 * static_cast<double>(stamp_ns - *last_ns_) : 0.0;
  if (gap_s < 0.0) count_ = 0;
  last_ns_ = stamp_ns;
  if (gap_s > 0.0 && gap_s <= kLongestGap_s) gaps_s_[count_++ % kGaps] = gap_s;
  Pace pace;
  const std::size_t known = std::min(count_, kGaps);
  if (known == 0) return pace;
  std::array<double, kGaps> sorted = gaps_s_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>((known - 1) / 2);
  std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(known));
  pace.frame_s = *middle;
  return pace;
}

}  // namespace pf
