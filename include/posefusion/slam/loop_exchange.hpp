// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "posefusion/loop/worker.hpp"
#include "posefusion/slam/map_correction.hpp"

namespace pf {

class Mapper;

/// When answers are taken.
enum class AnswerTime {
  after_lag,  ///< a fixed number of frames after the question, waiting if need be: the same on
              ///< every machine
  when_ready  ///< live: without waiting
};

/// Answers questions beside the mapper, in a thread or in another nodelet: in their order, except
/// that urgent ones may be answered sooner. The owner's thread alone may call it.
class LoopResponder {
 public:
  virtual ~LoopResponder() = default;

  /// Returns the question's number; they rise.
  virtual std::uint64_t ask(LoopQuestion question) = 0;

  /// Whether take() of that number would not wait.
  virtual bool isReady(std::uint64_t number) = 0;

  /// Waits for the answer to a question that was not taken yet; nothing where it was given up.
  /// Rethrows what the work threw.
  virtual std::optional<LoopAnswer> take(std::uint64_t number) = 0;

  /// Forgets all questions that were not taken yet.
  virtual void forget() = 0;

  /// Whether, since the last call, another loop closer has taken over, which knows no keyframes.
  virtual bool isReplaced() { return false; }
};

/// Carries the questions of a mapper to the loop closer, and the answers back when they are due;
/// the corrections of the map are prepared in a thread, one at a time. Its owner's thread alone may
/// call it.
class LoopExchange {
 public:
  LoopExchange(double lag_s, AnswerTime time, std::unique_ptr<LoopResponder> responder)
      : lag_s_(lag_s), time_(time), responder_(std::move(responder)) {}

  /// To be called after each frame of the mapper. Rethrows what the closer threw; it goes on.
  void serve(Mapper& mapper);

  /// After the last frame: waits for all answers and corrections and hands them on.
  void finish(Mapper& mapper);

  /// Forgets what is still unanswered; for a mapper that was reset.
  void reset();

  /// As of the last answer.
  const LoopCounts& counts() const { return counts_; }

  /// Time that each keyframe took beside the mapper, candidates and verification of all its loops,
  /// of the answers that report it.
  const std::vector<double>& verificationMs() const { return verification_ms_; }

  /// Total time spent waiting for answers (ms); about 0 with AnswerTime::when_ready.
  double waitedMs() const { return waited_ms_; }

  /// Questions that were given up.
  std::size_t unanswered() const { return unanswered_; }

  /// Questions that wait for their answers.
  std::size_t waiting() const { return asked_.size(); }

  /// Since when the oldest of them waits (s); 0: none does.
  double oldestWaitsS() const;

 private:
  struct Asked {
    std::int64_t at = 0;       ///< number of the frame
    std::uint64_t number = 0;  ///< of the question
    bool seeks_loops = false;
    /// Of a question for a place: see LoopQuestion::place_is_void.
    std::shared_ptr<std::atomic<bool>> is_void;
    std::chrono::steady_clock::time_point when{};

    bool isForPlace() const { return is_void != nullptr; }
  };

  void ask(LoopQuestion question);
  void askInParts(LoopQuestion question);
  std::deque<Asked>::iterator findDue(const Mapper& mapper);
  void take(std::deque<Asked>::iterator asked, Mapper& mapper);
  void correct(Mapper& mapper);
  void takeCorrection(Mapper& mapper);

  double lag_s_;
  AnswerTime time_;
  std::unique_ptr<LoopResponder> responder_;
  std::deque<Asked> asked_;
  std::int64_t frame_ = 0;  ///< its number
  std::size_t unanswered_ = 0;
  LoopCounts counts_;
  std::vector<double> verification_ms_;
  double waited_ms_ = 0;
  std::future<CorrectedMap> correcting_;
  std::int64_t correcting_since_ = 0;  ///< number of the frame
  bool is_correction_void_ = false;    ///< of a mapper that was reset
  std::future<void> freeing_;          ///< memory, beside
};

}  // namespace pf
