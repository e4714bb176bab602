// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/closer_link.hpp"

#include <ros/init.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/names.hpp"

namespace posefusion_ros {
namespace {

constexpr int kLoopQueue = 1000;
constexpr std::chrono::milliseconds kLook(50);  // how often a closer that goes is noticed
constexpr char kGone[] =
    "no loop closer (nodelet posefusion/loop_closer) is loaded: loops are not closed, and a lost "
    "camera is not looked for";

}  // namespace

CloserLink::CloserLink(const ros::NodeHandle& handle, double timeout_s)
    : timeout_(
          std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(timeout_s))) {
  ros::NodeHandle own(handle);
  own.setCallbackQueue(&queue_);
  answer_subscriber_ =
      own.subscribe(topics::kLoopConstraint, kLoopQueue, &CloserLink::onAnswer, this);
  question_publisher_ = own.advertise<LoopQuestionMessage>(topics::kKeyframe, kLoopQueue);
}

CloserLink::~CloserLink() { answer_subscriber_.shutdown(); }

std::uint64_t CloserLink::ask(pf::LoopQuestion question) {
  const auto message = boost::make_shared<LoopQuestionMessage>();
  message->header.stamp = toTime(question.stamp_ns);
  message->session = session_;
  message->number = ++number_;
  asked_[number_] = {Clock::now(), question.is_urgent, !isThere()};
  message->question = std::move(question);
  question_publisher_.publish(LoopQuestionMessage::ConstPtr(message));
  return number_;
}

bool CloserLink::isReady(std::uint64_t number) {
  listen({});
  const Question question = asked_.find(number);
  if (isAnswered(question) || isLost(question)) return true;
  if (Clock::now() < question->second.when + timeout_) return false;
  stall();
  return true;
}

/// Whether there will be no answer to it.
bool CloserLink::isLost(Question question) const {
  if (question->second.is_lost || !isThere() || !ros::ok()) return true;
  // Answers come in the order of the questions; urgent ones may only come sooner.
  return std::any_of(answers_.begin(), answers_.end(), [&](const auto& answer) {
    const auto other = asked_.find(answer.first);
    return other->first > question->first && !other->second.is_urgent;
  });
}

std::optional<pf::LoopAnswer> CloserLink::take(std::uint64_t number) {
  wait(asked_.find(number));
  asked_.erase(number);
  const auto found = answers_.find(number);
  if (found == answers_.end()) return std::nullopt;
  const LoopAnswerMessage::ConstPtr answer = found->second;
  answers_.erase(found);
  if (!answer->error.empty()) throw std::runtime_error("loop closer: " + answer->error);
  return answer->answer;
}

/// Blocks until the question is answered, given up, or known to stay without an answer.
void CloserLink::wait(Question question) {
  listen({});
  if (isAnswered(question) || is_stalled_) return;
  Clock::duration waited{};  // looks are counted: a process that was stopped has not waited
  while (!isAnswered(question)) {
    if (hurries_) {
      is_stalled_ = true;
      return;
    }
    if (isLost(question)) {
      complaint_ = kGone;
      return;
    }
    if (waited >= timeout_) return stall();
    const Clock::time_point begin = Clock::now();
    listen(kLook);
    waited += std::min<Clock::duration>(Clock::now() - begin, 2 * kLook);
  }
}

void CloserLink::stall() {
  is_stalled_ = true;
  std::ostringstream text;
  text << "the loop closer has not answered for " << std::chrono::duration<double>(timeout_).count()
       << " s: going on without it until it answers again";
  complaint_ = text.str();
}

void CloserLink::forget() {
  asked_.clear();
  answers_.clear();
}

bool CloserLink::isReplaced() {
  listen({});
  const bool is_there = isThere();
  if (is_there && !was_there_) is_replaced_ = true;
  for (auto& [number, asked] : asked_) asked.is_lost = asked.is_lost || !is_there;
  was_there_ = is_there;
  return std::exchange(is_replaced_, false);
}

void CloserLink::listen(std::chrono::milliseconds patience) {
  queue_.callAvailable(ros::WallDuration(std::chrono::duration<double>(patience).count()));
}

void CloserLink::onAnswer(const LoopAnswerMessage::ConstPtr& answer) {
  if (answer->session != session_) return;
  is_stalled_ = false;
  if (closer_ != 0 && closer_ != answer->closer) is_replaced_ = true;
  closer_ = answer->closer;
  // One that was given up or forgotten is not wanted any more.
  if (asked_.count(answer->number) > 0) answers_[answer->number] = answer;
}

}  // namespace posefusion_ros
