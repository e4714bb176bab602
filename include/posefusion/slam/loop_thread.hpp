// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <future>
#include <optional>

#include "posefusion/loop/worker.hpp"

namespace pf {

/// Runs a LoopWorker in a thread of its own. An answer is due a fixed number of frames after its
/// question, so that what comes of it does not depend on the speed of the machine. The owner's
/// thread alone may call it.
class LoopThread {
 public:
  LoopThread(const LoopConfig& config, const TrackingConfig& tracking)
      : lag_frames_(config.answer_lag_frames),
        worker_(std::make_shared<LoopWorker>(config, tracking)) {}

  void ask(LoopQuestion question);

  /// The next answer that is due after frame `number`, which is waited for; call until there is
  /// none. What the worker threw is thrown here.
  std::optional<LoopAnswer> due(std::int64_t number);

 private:
  struct Asked {
    std::int64_t number = 0;
    std::shared_future<LoopAnswer> answer;
  };

  int lag_frames_;
  std::shared_ptr<LoopWorker> worker_;
  std::deque<Asked> asked_;
};

}  // namespace pf
