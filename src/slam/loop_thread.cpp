// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/loop_thread.hpp"

#include <utility>

namespace pf {

void LoopThread::ask(LoopQuestion question) {
  // Each question waits for the one before: the worker sees them in their order.
  const std::shared_future<LoopAnswer> before =
      asked_.empty() ? std::shared_future<LoopAnswer>() : asked_.back().answer;
  const std::int64_t number = question.number;
  auto work = [worker = worker_, before, question = std::move(question)] {
    if (before.valid()) before.wait();
    return worker->answer(question);
  };
  asked_.push_back({number, std::async(std::launch::async, std::move(work)).share()});
}

std::optional<LoopAnswer> LoopThread::due(std::int64_t number) {
  if (asked_.empty() || number < asked_.front().number + lag_frames_) return std::nullopt;
  const std::shared_future<LoopAnswer> answer = asked_.front().answer;
  asked_.pop_front();
  return answer.get();
}

}  // namespace pf
