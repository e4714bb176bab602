// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <optional>

#include "posefusion/loop/worker.hpp"

namespace pf {

class Mapper;

/// When answers are taken.
enum class AnswerTime {
  after_lag,  ///< so many frames after the question, waited for: the same on every machine
  when_ready  ///< live: nobody waits
};

/// Runs the loop closer in a thread of its own, beside a mapper: hands on what the mapper asks, and
/// the answers. Its owner's thread alone may call it.
class LoopThread {
 public:
  LoopThread(const LoopConfig& config, const TrackingConfig& tracking, AnswerTime time);

  /// After each frame of the mapper. What the closer threw is thrown here; it goes on afterwards.
  void serve(Mapper& mapper);

  /// After the last frame: waits for all answers and hands them on.
  void finish(Mapper& mapper);

  /// Forgets what is still unanswered; for a mapper that was reset.
  void reset();

  /// As of the last answer.
  const LoopCounts& counts() const { return counts_; }

 private:
  struct Asked {
    std::int64_t number = 0;
    std::shared_future<LoopAnswer> answer;
  };

  void ask(LoopQuestion question);
  bool isDue() const;
  void takeOne(Mapper& mapper);

  int lag_frames_;
  AnswerTime time_;
  std::shared_ptr<LoopWorker> worker_;
  std::shared_future<LoopAnswer> last_;  ///< of the newest question
  std::deque<Asked> asked_;
  std::int64_t number_ = 0;  ///< of the frame
  LoopCounts counts_;
};

}  // namespace pf
