// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pf {

/// posefusion_evaluate GT EST
struct TrajectoryQuestion {
  std::string truth, estimate;
  std::string plot;  ///< picture to write, empty: none
  bool with_scale = false;
  bool json = false;
};

/// posefusion_evaluate run RUN_DIR INPUT
struct RunQuestion {
  std::string run, input;
  std::string truth;   ///< empty: that of the input
  std::string camera;  ///< empty: that of the input
  std::string masks;   ///< empty: INPUT/mask
  std::size_t first_frame = 50, last_frame = 300;
  bool json = false;
};

/// Each prints its answer on stdout. They throw InputError.
void evaluateTrajectory(const TrajectoryQuestion& question);
void evaluateRun(const RunQuestion& question);
/// posefusion_evaluate masks TRUTH_DIR MASK_DIR
void evaluateMasks(const std::string& truth, const std::string& masks, bool json);

}  // namespace pf
