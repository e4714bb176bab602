// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/loop_thread.hpp"

#include <chrono>
#include <cstdint>
#include <future>
#include <map>
#include <utility>

namespace pf {
namespace {

class ThreadResponder : public LoopResponder {
 public:
  explicit ThreadResponder(const Config& config)
      : worker_(std::make_shared<LoopWorker>(config.loop, config.tracking, depthSensorOf(config),
                                             config.calibration)) {}

  std::uint64_t ask(LoopQuestion question) override {
    // Each question waits for the one before: the worker sees them in their order. A future holds
    // its work, so that both are let go here: else each would hold all those before.
    auto work = [worker = worker_, before = last_, question = std::move(question)]() mutable {
      if (before.valid()) std::exchange(before, {}).wait();
      const LoopQuestion mine = std::move(question);
      return worker->answer(mine);
    };
    last_ = std::async(std::launch::async, std::move(work)).share();
    answers_[++number_] = last_;
    return number_;
  }

  bool isReady(std::uint64_t number) override {
    return answers_.at(number).wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }

  std::optional<LoopAnswer> take(std::uint64_t number) override {
    const std::shared_future<LoopAnswer> answer = std::move(answers_.at(number));
    answers_.erase(number);
    return answer.get();
  }

  void forget() override { answers_.clear(); }

 private:
  std::shared_ptr<LoopWorker> worker_;
  std::shared_future<LoopAnswer> last_;  ///< of the newest question
  std::uint64_t number_ = 0;
  std::map<std::uint64_t, std::shared_future<LoopAnswer>> answers_;
};

}  // namespace

LoopThread::LoopThread(const Config& config, AnswerTime time)
    : LoopExchange(config.loop.answer_lag_s, time, std::make_unique<ThreadResponder>(config)) {}

}  // namespace pf
