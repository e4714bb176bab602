// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/loop_exchange.hpp"

#include <utility>

#include "posefusion/core/stopwatch.hpp"
#include "posefusion/slam/mapper.hpp"

namespace pf {

void LoopExchange::serve(Mapper& mapper) {
  if (responder_->isReplaced()) mapper.introduceCloser();
  if (auto question = mapper.takeQuestion()) {
    asked_.push_back({number_, question->place != nullptr});
    responder_->ask(std::move(*question));
  }
  while (isDue(mapper)) takeOne(mapper);
  ++number_;
}

void LoopExchange::finish(Mapper& mapper) {
  while (!asked_.empty()) takeOne(mapper);
}

void LoopExchange::reset() {
  asked_.clear();
  responder_->forget();
}

bool LoopExchange::isDue(const Mapper& mapper) const {
  if (asked_.empty()) return false;
  if (time_ == AnswerTime::after_lag) {
    return number_ >= asked_.front().number + mapper.pace().framesIn(lag_s_);
  }
  return responder_->isReady();
}

void LoopExchange::takeOne(Mapper& mapper) {
  const Asked asked = asked_.front();
  asked_.pop_front();
  // Where there is no answer the mapper is told that nothing was found, so that it asks again.
  LoopAnswer nothing;
  nothing.asked_for_place = asked.for_place;
  std::optional<LoopAnswer> answer;
  Stopwatch watch;
  try {
    answer = responder_->take();
    waited_ms_ += watch.lapMs();
  } catch (...) {
    ++unanswered_;
    mapper.take(nothing);
    throw;
  }
  if (answer) {
    counts_ = answer->counts;
    if (answer->verification_ms > 0) verification_ms_.push_back(answer->verification_ms);
  } else {
    ++unanswered_;
  }
  mapper.take(answer ? *answer : nothing);
}

}  // namespace pf
