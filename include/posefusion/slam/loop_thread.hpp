// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/slam/config.hpp"
#include "posefusion/slam/loop_exchange.hpp"

namespace pf {

/// An exchange with a loop closer that works in a thread of its own.
class LoopThread : public LoopExchange {
 public:
  LoopThread(const Config& config, AnswerTime time);
};

}  // namespace pf
