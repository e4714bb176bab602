// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_openni2/clock_map.hpp"

#include <algorithm>

namespace pf::openni2 {
namespace {

constexpr std::int64_t kNsPerUs = 1000;
/// Faster than any two quartz clocks drift apart (usual: below 100 ppm).
constexpr double kMaxDrift = 200e-6;
/// Frames of both streams this close are of one moment.
constexpr std::int64_t kSameMoment_us = 2000;
/// A device clock that steps back by so much has started anew; less is the order of two threads.
constexpr std::int64_t kStepBack_us = 300'000;
/// All of so many frames in a row so late: a clock has jumped, it is not the transfer.
constexpr std::int64_t kJump_ns = 1'000'000'000;
constexpr int kJumpFrames = 20;
/// Between the last frame of a file and the first of its next round.
constexpr std::int64_t kRoundGap_ns = 33'333'333;
constexpr std::int64_t kRoundOverlap_ns = 300'000'000;

}  // namespace

std::int64_t ClockMap::toHostNs(std::int64_t device_us, std::int64_t arrival_ns) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::int64_t observed_ns = arrival_ns - device_us * kNsPerUs;
  if (isOfLastRound(device_us, arrival_ns)) return device_us * kNsPerUs + last_round_offset_ns_;
  const bool stepped_back = device_us < newest_us_ - kStepBack_us;
  if (!started_ || stepped_back) {
    last_round_offset_ns_ = offset_ns_;
    round_arrival_ns_ = started_ ? arrival_ns : 0;
    restart(device_us, observed_ns);
  } else if (source_ == Source::live) {
    follow(device_us, observed_ns);
  }
  newest_us_ = std::max(newest_us_, device_us);
  last_delay_ns_ = observed_ns - offset_ns_;
  return device_us * kNsPerUs + offset_ns_;
}

std::int64_t ClockMap::lastDelayNs() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return last_delay_ns_;
}

// A file's streams do not start their next round together: one may still deliver its last frames.
bool ClockMap::isOfLastRound(std::int64_t device_us, std::int64_t arrival_ns) const {
  return source_ == Source::recorded && arrival_ns - round_arrival_ns_ < kRoundOverlap_ns &&
         device_us > newest_us_ + kStepBack_us;
}

void ClockMap::restart(std::int64_t device_us, std::int64_t observed_ns) {
  const std::int64_t last_stamp_ns = newest_us_ * kNsPerUs + offset_ns_;
  offset_ns_ = observed_ns;
  if (started_ && source_ == Source::recorded) {
    // Played faster than recorded, the stamps run ahead of the host; they must not step back.
    offset_ns_ = std::max(offset_ns_, last_stamp_ns + kRoundGap_ns - device_us * kNsPerUs);
  }
  newest_us_ = device_us;
  late_in_a_row_ = 0;
  started_ = true;
}

void ClockMap::follow(std::int64_t device_us, std::int64_t observed_ns) {
  const std::int64_t step_us = device_us - newest_us_;
  if (step_us <= kSameMoment_us) return;  // the other stream's image of a moment known already
  late_in_a_row_ = observed_ns - offset_ns_ > kJump_ns ? late_in_a_row_ + 1 : 0;
  if (late_in_a_row_ >= kJumpFrames) return restart(device_us, observed_ns);
  offset_ns_ += static_cast<std::int64_t>(kMaxDrift * static_cast<double>(step_us * kNsPerUs));
  offset_ns_ = std::min(offset_ns_, observed_ns);
}

}  // namespace pf::openni2
