// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "posefusion/core/stopwatch.hpp"

namespace pf {

/// Progress on stderr: a bar with the remaining time on a terminal, now and then a line otherwise.
class Progress {
 public:
  explicit Progress(std::size_t total);
  ~Progress();

  void update(std::size_t done);
  /// A line that does not tear the bar.
  void say(const std::string& line);

 private:
  void draw(std::size_t done, bool last);

  std::size_t total_;
  bool terminal_;
  std::size_t done_ = 0;
  double elapsed_ms_ = 0;
  double drawn_ms_ = 0;
  Stopwatch watch_;
};

}  // namespace pf
