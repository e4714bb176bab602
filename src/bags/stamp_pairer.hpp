// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <limits>
#include <optional>
#include <utility>

namespace posefusion_ros {

/// Pairs two streams by the nearest stamp as they come. Items have a `stamp_ns`, growing within
/// each stream. An item is used once, by the nearer of two neighbours.
template <typename Item>
class StampPairer {
 public:
  explicit StampPairer(std::int64_t max_difference_ns) : max_difference_ns_(max_difference_ns) {}

  void addFirst(Item item) { first_.push_back(std::move(item)); }
  void addSecond(Item item) {
    second_.push_back(std::move(item));
    if (!first_.empty() || second_.size() <= kMaxWaiting) return;
    second_.pop_front();
    ++unpaired_second_;
  }
  /// No more items will come.
  void finish() { finished_ = true; }

  /// The next pair, once no later item can change it; nothing when more items are needed.
  std::optional<std::pair<Item, Item>> next() {
    while (!first_.empty() && isDecidable()) {
      dropBefore(first_.front().stamp_ns);
      const std::size_t at = partner();
      Item item = std::move(first_.front());
      first_.pop_front();
      if (at == second_.size()) {
        ++unpaired_first_;
        continue;
      }
      unpaired_second_ += at;
      std::pair<Item, Item> pair(std::move(item), std::move(second_[at]));
      second_.erase(second_.begin(), second_.begin() + static_cast<std::ptrdiff_t>(at) + 1);
      return pair;
    }
    if (finished_) {
      unpaired_second_ += second_.size();
      second_.clear();
    }
    return std::nullopt;
  }

  std::size_t unpairedFirst() const { return unpaired_first_; }
  std::size_t unpairedSecond() const { return unpaired_second_; }

 private:
  /// One stream far ahead of the other is not waited for: its partner has stopped.
  static constexpr std::size_t kMaxWaiting = 90;

  bool isDecidable() const {
    if (finished_ || first_.size() > kMaxWaiting) return true;
    const bool second_passed =
        !second_.empty() && second_.back().stamp_ns >= first_.front().stamp_ns;
    return second_passed && (first_.size() > 1 || second_.size() > kMaxWaiting);
  }

  /// Drops second items that are before all but the last one not after `stamp_ns`: no first item to
  /// come is nearer to them.
  void dropBefore(std::int64_t stamp_ns) {
    while (second_.size() > 1 && second_[1].stamp_ns <= stamp_ns) {
      second_.pop_front();
      ++unpaired_second_;
    }
  }

  std::int64_t distance(const Item& a, const Item& b) const {
    return std::llabs(a.stamp_ns - b.stamp_ns);
  }

  /// Index of the second item for the front of the first, second_.size() when there is none.
  std::size_t partner() const {
    const std::size_t none = second_.size();
    std::size_t best = none;
    std::int64_t best_distance = max_difference_ns_;
    for (std::size_t i = 0; i < std::min<std::size_t>(2, second_.size()); ++i) {
      const std::int64_t d = distance(first_.front(), second_[i]);
      const bool wanted_by_next = first_.size() > 1 && distance(first_[1], second_[i]) < d;
      if (d < best_distance && !wanted_by_next) {
        best = i;
        best_distance = d;
      }
    }
    return best;
  }

  std::int64_t max_difference_ns_;
  std::deque<Item> first_, second_;
  std::size_t unpaired_first_ = 0, unpaired_second_ = 0;
  bool finished_ = false;
};

}  // namespace posefusion_ros
