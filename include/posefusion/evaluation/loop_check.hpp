// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/graph/constraint.hpp"
#include "posefusion/graph/keyframe.hpp"

namespace pf {

/// Beyond these a loop joins what is not one place.
constexpr double kWrongLoop_m = 0.10;
constexpr double kWrongLoop_deg = 3.0;

/// How far the motion that a loop measured is from the true one.
struct LoopError {
  int from = -1, to = -1;  ///< keyframes
  double shift_m = 0, turn_deg = 0;

  bool isWrong() const { return shift_m > kWrongLoop_m || turn_deg > kWrongLoop_deg; }
};

/// Of each loop among the constraints; those between keyframes without a true pose within 0.02 s
/// are left out. Constraints must be between the keyframes given.
std::vector<LoopError> checkLoops(const Trajectory& truth, const std::vector<Keyframe>& keyframes,
                                  const std::vector<PoseConstraint>& constraints);

}  // namespace pf
