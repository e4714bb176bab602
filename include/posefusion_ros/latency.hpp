// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

namespace posefusion_ros {

/// How long results take, by the stamps of their frames. Thread safe.
class LatencyMeter {
 public:
  using Time = std::chrono::steady_clock::time_point;

  void sent(std::int64_t stamp_ns, Time now) {
    const std::lock_guard<std::mutex> lock(mutex_);
    sent_[stamp_ns] = now;
  }

  /// The first result of a frame counts; that of a stamp never sent does not.
  void arrived(std::int64_t stamp_ns, Time now) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = sent_.find(stamp_ns);
    if (found == sent_.end()) return;
    times_s_.push_back(std::chrono::duration<double>(now - found->second).count());
    sent_.erase(found);
  }

  std::size_t count() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return times_s_.size();
  }

  /// Seconds within which this part of the results came, 0.5 for the median; 0 without results.
  double quantile(double part) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (times_s_.empty()) return 0;
    std::vector<double> sorted = times_s_;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::int64_t, Time> sent_;
  std::vector<double> times_s_;
};

}  // namespace posefusion_ros
