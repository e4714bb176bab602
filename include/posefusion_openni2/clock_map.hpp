// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <mutex>

namespace pf::openni2 {

/// Maps the device's clock to the host's. The host sees a frame late, by a transfer time that
/// varies; it never sees it early. So the smallest difference of host and device time is the best
/// estimate of their offset; it may rise slowly, at the rate two quartz clocks drift apart, and
/// jitter above it is filtered away. Frames of one device time get one host time, from both
/// streams. Both a step back of the device's clock (restarted device, repeated file) and a jump of
/// either clock start it anew. Any thread.
class ClockMap {
 public:
  enum class Source {
    live,     ///< a device that runs in real time
    recorded  ///< a file: the distances of its frames are kept exactly
  };

  explicit ClockMap(Source source) : source_(source) {}

  /// Host time in nanoseconds of a frame that was taken at `device_us` and arrived at `arrival_ns`.
  std::int64_t toHostNs(std::int64_t device_us, std::int64_t arrival_ns);

  /// How late after its stamp the last frame came, in nanoseconds.
  std::int64_t lastDelayNs() const;

 private:
  bool isOfLastRound(std::int64_t device_us, std::int64_t arrival_ns) const;
  void restart(std::int64_t device_us, std::int64_t observed_ns);
  void follow(std::int64_t device_us, std::int64_t observed_ns);

  const Source source_;
  mutable std::mutex mutex_;
  bool started_ = false;
  std::int64_t offset_ns_ = 0;
  std::int64_t newest_us_ = 0;
  std::int64_t last_round_offset_ns_ = 0;
  std::int64_t round_arrival_ns_ = 0;  ///< of its first frame; 0 in the first round
  int late_in_a_row_ = 0;
  std::int64_t last_delay_ns_ = 0;
};

}  // namespace pf::openni2
