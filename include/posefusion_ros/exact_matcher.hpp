// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/shared_ptr.hpp>

#include <ros/time.h>
#include <cstddef>
#include <functional>
#include <map>
#include <tuple>
#include <utility>

namespace posefusion_ros {

/// Puts together the messages of one stamp, one of each topic. Each topic's stamps rise; where they
/// go back (a bag played again), that topic's waiting messages belong to the past and are
/// forgotten. Unlike message_filters' ExactTime it needs no making anew then. Not thread safe.
template <typename... Messages>
class ExactMatcher {
 public:
  using Set = std::tuple<boost::shared_ptr<const Messages>...>;
  using Handler = std::function<void(const Set&)>;

  /// `capacity`: stamps that wait at most; beyond it the oldest is forgotten.
  ExactMatcher(std::size_t capacity, Handler handler)
      : capacity_(capacity), handler_(std::move(handler)) {}

  /// Takes a message of topic number Index; calls the handler when its set is whole.
  template <std::size_t Index>
  void add(const std::tuple_element_t<Index, Set>& message) {
    const ros::Time stamp = message->header.stamp;
    if (stamp < last_[Index]) forget<Index>();
    last_[Index] = stamp;
    Set& set = waiting_[stamp];
    std::get<Index>(set) = message;
    if (isWhole(set)) {
      const Set whole = set;
      waiting_.erase(waiting_.begin(), waiting_.upper_bound(stamp));
      handler_(whole);
    } else if (waiting_.size() > capacity_) {
      waiting_.erase(waiting_.begin());
      ++lost_;
    }
  }

  /// Sets given up because the capacity was reached.
  std::size_t lost() const { return lost_; }
  std::size_t waiting() const { return waiting_.size(); }

 private:
  static bool isWhole(const Set& set) {
    return std::apply([](const auto&... message) { return (static_cast<bool>(message) && ...); },
                      set);
  }

  template <std::size_t Index>
  void forget() {
    for (auto entry = waiting_.begin(); entry != waiting_.end();) {
      std::get<Index>(entry->second).reset();
      const bool empty =
          std::apply([](const auto&... message) { return !(static_cast<bool>(message) || ...); },
                     entry->second);
      entry = empty ? waiting_.erase(entry) : std::next(entry);
    }
  }

  std::size_t capacity_;
  Handler handler_;
  std::map<ros::Time, Set> waiting_;
  ros::Time last_[sizeof...(Messages)];
  std::size_t lost_ = 0;
};

}  // namespace posefusion_ros
