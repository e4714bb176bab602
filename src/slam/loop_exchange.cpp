// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/loop_exchange.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "posefusion/core/parallel.hpp"
#include "posefusion/core/stopwatch.hpp"
#include "posefusion/slam/mapper.hpp"

namespace pf {
namespace {

// Of keyframes that wait so many times to be compared with others, live: with a fifth of a second
// for each, the next would be answered more than a second late. Its neighbours see the same.
constexpr std::ptrdiff_t kMostSeeking = 6;

}  // namespace

void LoopExchange::serve(Mapper& mapper) {
  if (responder_->isReplaced()) mapper.introduceCloser();
  // What an offline run counts must not depend on when this is seen.
  if (time_ == AnswerTime::when_ready && !mapper.isLookedFor()) {
    for (const Asked& asked : asked_) {
      if (asked.isForPlace()) *asked.is_void = true;
    }
  }
  if (auto question = mapper.takeQuestion()) {
    if (time_ == AnswerTime::when_ready) {
      askInParts(std::move(*question));
    } else {
      ask(std::move(*question));
    }
  }
  for (auto due = findDue(mapper); due != asked_.end(); due = findDue(mapper)) take(due, mapper);
  correct(mapper);
  ++frame_;
}

/// Takes in the correction in work when it is due, and begins the next.
void LoopExchange::correct(Mapper& mapper) {
  if (correcting_.valid()) {
    const bool is_due =
        time_ == AnswerTime::after_lag
            ? frame_ >= correcting_since_ + mapper.pace().framesIn(lag_s_)
            : correcting_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    if (!is_due) return;
    takeCorrection(mapper);
  }
  auto correction = mapper.takeCorrection();
  if (!correction) return;
  correcting_since_ = frame_;
  is_correction_void_ = false;
  correcting_ = std::async(std::launch::async, [work = std::move(*correction)]() mutable {
    return inOneThread([&] { return prepare(std::move(work)); });
  });
}

void LoopExchange::takeCorrection(Mapper& mapper) {
  Stopwatch watch;
  try {
    CorrectedMap corrected = correcting_.get();
    waited_ms_ += watch.lapMs();
    if (!is_correction_void_) mapper.take(corrected);
    // A future keeps its work: what that holds goes with its end.
    freeing_ = std::async(std::launch::async, [old = std::move(corrected)]() mutable {
      const CorrectedMap gone = std::move(old);
    });
  } catch (...) {
    if (!is_correction_void_) mapper.abandonCorrection();
    throw;
  }
}

void LoopExchange::finish(Mapper& mapper) {
  while (!asked_.empty()) take(asked_.begin(), mapper);
  if (correcting_.valid()) takeCorrection(mapper);
  mapper.settle();
}

void LoopExchange::reset() {
  asked_.clear();
  is_correction_void_ = true;
  responder_->forget();
}

void LoopExchange::ask(LoopQuestion question) {
  Asked asked;
  asked.at = frame_;
  asked.seeks_loops = question.keyframe && question.seeks_loops;
  asked.when = std::chrono::steady_clock::now();
  if (question.place) {
    asked.is_void = std::make_shared<std::atomic<bool>>(false);
    question.place_is_void = asked.is_void;
  }
  asked.number = responder_->ask(std::move(question));
  asked_.push_back(std::move(asked));
}

double LoopExchange::oldestWaitsS() const {
  if (asked_.empty()) return 0;
  const auto since = std::chrono::steady_clock::now() - asked_.front().when;
  return std::chrono::duration<double>(since).count();
}

/// Relocalisation is asked separately, so that it does not wait for the rest of the question.
void LoopExchange::askInParts(LoopQuestion question) {
  LoopQuestion place;
  place.stamp_ns = question.stamp_ns;
  place.depth_version = question.depth_version;
  place.place = std::exchange(question.place, nullptr);
  place.is_urgent = true;
  const auto seeking =
      std::count_if(asked_.begin(), asked_.end(), [](const Asked& a) { return a.seeks_loops; });
  question.seeks_loops = seeking < kMostSeeking;
  // Asked first: an idle closer has taken it in before it looks for the place.
  if (question.tellsMore()) ask(std::move(question));
  if (place.place) ask(std::move(place));
}

/// The first question whose answer is to be taken now.
std::deque<LoopExchange::Asked>::iterator LoopExchange::findDue(const Mapper& mapper) {
  if (asked_.empty()) return asked_.end();
  if (time_ == AnswerTime::after_lag) {
    const bool due = frame_ >= asked_.front().at + mapper.pace().framesIn(lag_s_);
    return due ? asked_.begin() : asked_.end();
  }
  // Urgent are those for a place; all others come in their order.
  const auto first =
      std::find_if(asked_.begin(), asked_.end(), [](const Asked& a) { return !a.isForPlace(); });
  const auto place =
      std::find_if(asked_.begin(), asked_.end(), [](const Asked& a) { return a.isForPlace(); });
  for (const auto& one : {place, first}) {
    if (one != asked_.end() && responder_->isReady(one->number)) return one;
  }
  return asked_.end();
}

void LoopExchange::take(std::deque<Asked>::iterator which, Mapper& mapper) {
  const Asked asked = *which;
  asked_.erase(which);
  // Without an answer the mapper gets "nothing found", so that it asks again.
  LoopAnswer nothing;
  nothing.asked_for_place = asked.isForPlace();
  std::optional<LoopAnswer> answer;
  Stopwatch watch;
  try {
    answer = responder_->take(asked.number);
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
