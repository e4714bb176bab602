// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/callback_queue.h>
#include <ros/node_handle.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "posefusion/slam/loop_exchange.hpp"
#include "posefusion_ros/loop_messages.hpp"

namespace posefusion_ros {

/// The way from fusion to the nodelet posefusion/loop_closer and back, by topics. A closer that is
/// missing is not waited for, one that does not answer only once until it answers again; what
/// it says later is not used. One thread uses it, besides isThere() and hurry(); answers come in a
/// queue that this thread serves while it looks for them.
class CloserLink : public pf::LoopResponder {
 public:
  /// `timeout_s`: how long an answer is waited for at most, wall time.
  CloserLink(const ros::NodeHandle& handle, double timeout_s);
  ~CloserLink() override;

  std::uint64_t ask(pf::LoopQuestion question) override;
  bool isReady(std::uint64_t number) override;
  std::optional<pf::LoopAnswer> take(std::uint64_t number) override;
  void forget() override;
  bool isReplaced() override;

  /// Whether a closer is connected. Thread safe.
  bool isThere() const { return answer_subscriber_.getNumPublishers() > 0; }

  /// From now on, until hurry(false), nothing is waited for; a closer waited for counts as stalled.
  /// Thread safe.
  void hurry(bool hurries) { hurries_ = hurries; }

  /// What went wrong since the last call; empty for nothing.
  std::string takeComplaint() { return std::exchange(complaint_, {}); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Asked {
    Clock::time_point when;
    bool is_urgent = false;  // answered out of turn
    bool is_lost = false;    // the closer that was asked is gone
  };
  using Question = std::map<std::uint64_t, Asked>::const_iterator;

  void onAnswer(const LoopAnswerMessage::ConstPtr& answer);
  void listen(std::chrono::milliseconds patience);
  bool isAnswered(Question question) const { return answers_.count(question->first) > 0; }
  bool isLost(Question question) const;
  void wait(Question question);
  void stall();

  ros::CallbackQueue queue_;  // of answers: outlives its subscriber
  ros::Publisher question_publisher_;
  ros::Subscriber answer_subscriber_;
  const Clock::duration timeout_;
  const std::uint64_t session_ = newIdentity();
  std::uint64_t number_ = 0;
  std::map<std::uint64_t, Asked> asked_;                          // by number
  std::map<std::uint64_t, LoopAnswerMessage::ConstPtr> answers_;  // by number, of those asked
  std::uint64_t closer_ = 0;                                      // that answered last; 0: none yet
  bool was_there_ = true, is_replaced_ = false, is_stalled_ = false;
  std::atomic<bool> hurries_{false};
  std::string complaint_;
};

}  // namespace posefusion_ros
