// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

namespace pf {

/// Wall time of stages, for reports only: no result may depend on it.
class Stopwatch {
 public:
  /// Milliseconds since the last lap (or since construction); starts the next lap.
  double lapMs() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double, std::milli> lap = now - start_;
    start_ = now;
    return lap.count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace pf
