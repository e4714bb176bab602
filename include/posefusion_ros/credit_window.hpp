// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <set>

namespace posefusion_ros {

/// Frames under way: sent, but not reported yet. One status for the stamp of a frame is one credit.
/// Thread safe. All times are wall times.
class CreditWindow {
 public:
  void sent(std::int64_t stamp_ns) {
    const std::lock_guard<std::mutex> lock(mutex_);
    under_way_.insert(stamp_ns);
  }

  /// A status came in; false when no frame of this stamp is under way.
  bool reported(std::int64_t stamp_ns) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const bool known = under_way_.erase(stamp_ns) > 0;
    ++events_;
    changed_.notify_all();
    return known;
  }

  /// Waits until fewer than `limit` frames are under way; false when `patience` passed without any
  /// status, or when `goes_on` (asked every now and then) is false.
  bool waitBelow(
      std::size_t limit, std::chrono::duration<double> patience,
      const std::function<bool()>& goes_on = [] { return true; }) {
    using Clock = std::chrono::steady_clock;
    std::unique_lock<std::mutex> lock(mutex_);
    auto end = Clock::now() + patience;
    while (under_way_.size() >= limit) {
      const std::uint64_t before = events_;
      changed_.wait_for(lock, std::min(patience, kAskEvery));
      if (events_ != before) end = Clock::now() + patience;
      if (!goes_on() || Clock::now() > end) return under_way_.size() < limit;
    }
    return true;
  }

  std::size_t underWay() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return under_way_.size();
  }

 private:
  static constexpr std::chrono::duration<double> kAskEvery{0.1};

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::int64_t> under_way_;
  std::uint64_t events_ = 0;
};

}  // namespace posefusion_ros
