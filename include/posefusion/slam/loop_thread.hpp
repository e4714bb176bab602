// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/slam/loop_exchange.hpp"

namespace pf {

/// An exchange with a loop closer that works in a thread of its own.
class LoopThread : public LoopExchange {
 public:
  LoopThread(const LoopConfig& config, const TrackingConfig& tracking, const DepthSensor& sensor,
             AnswerTime time);
};

}  // namespace pf
