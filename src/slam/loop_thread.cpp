// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/loop_thread.hpp"

#include <chrono>
#include <utility>

#include "posefusion/slam/mapper.hpp"

namespace pf {

LoopThread::LoopThread(const LoopConfig& config, const TrackingConfig& tracking, AnswerTime time)
    : lag_frames_(config.answer_lag_frames),
      time_(time),
      worker_(std::make_shared<LoopWorker>(config, tracking)) {}

void LoopThread::serve(Mapper& mapper) {
  if (auto question = mapper.takeQuestion()) ask(std::move(*question));
  while (isDue()) takeOne(mapper);
  ++number_;
}

void LoopThread::finish(Mapper& mapper) {
  while (!asked_.empty()) takeOne(mapper);
}

void LoopThread::reset() { asked_.clear(); }

void LoopThread::ask(LoopQuestion question) {
  // Each question waits for the one before: the worker sees them in their order.
  auto work = [worker = worker_, before = last_, question = std::move(question)] {
    if (before.valid()) before.wait();
    return worker->answer(question);
  };
  last_ = std::async(std::launch::async, std::move(work)).share();
  asked_.push_back({number_, last_});
}

bool LoopThread::isDue() const {
  if (asked_.empty()) return false;
  const Asked& first = asked_.front();
  if (time_ == AnswerTime::after_lag) return number_ >= first.number + lag_frames_;
  return first.answer.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

void LoopThread::takeOne(Mapper& mapper) {
  const std::shared_future<LoopAnswer> answer = asked_.front().answer;
  asked_.pop_front();
  mapper.take(answer.get());
  counts_ = answer.get().counts;
}

}  // namespace pf
