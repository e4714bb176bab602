// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace posefusion_ros {

/// When a link that was cut is worth a new connection. TCP doubles the pause between its tries as
/// long as nothing is acknowledged, so it is back only up to as long after the cut as the cut
/// lasted. Here: silence, and the other machine can be reached. Not thread safe.
class RenewalClock {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit RenewalClock(double silent_s) : silent_(silent_s) {}

  void heard(Time now);

  bool isSilent(Time now) const { return has_heard_ && now - heard_ >= silent_; }
  /// Whether to see if the other machine can be reached: it is not asked without a pause.
  bool isToLook(Time now) const;

  /// It was looked for; true: connect anew now. Where the other side just has nothing to say, that
  /// changes nothing: the next try comes after a pause that grows, up to 10 s, until something is
  /// heard or the other side is away in between.
  bool looked(Time now, bool reachable);

 private:
  std::chrono::duration<double> silent_;
  Time heard_{}, looked_{}, renewed_{};
  bool has_heard_ = false;
  std::chrono::duration<double> pause_{0};
};

/// Watches the messages of a topic that comes from another machine, and connects anew when they
/// stop and that machine can be reached. It does so as a master does where a publisher comes and
/// goes, by the slave API of the own node, and asks no master, which may be beyond the link.
/// Other publishers of the topic that nothing was heard of are left out then.
class LinkRenewal {
 public:
  /// `tell` is called from a thread of its own when a connection is made anew.
  LinkRenewal(std::string topic, double silent_s, std::function<void()> tell);
  ~LinkRenewal();
  LinkRenewal(const LinkRenewal&) = delete;
  LinkRenewal& operator=(const LinkRenewal&) = delete;

  /// A message has come from this node.
  void heard(const std::string& publisher);

 private:
  void run();
  void learn(const std::string& publisher);
  bool isReachable() const;
  void renew() const;

  std::string topic_;
  std::function<void()> tell_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  RenewalClock clock_;
  std::string publisher_;                    // of the last message
  std::map<std::string, std::string> uris_;  // of publishers; the thread's alone
  std::thread thread_;                       // last: it uses the others
};

}  // namespace posefusion_ros
