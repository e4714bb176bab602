// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/loop_check.hpp"

#include <cmath>

#include "posefusion/core/se3.hpp"
#include "posefusion/evaluation/metrics.hpp"

namespace pf {

std::vector<LoopError> checkLoops(const Trajectory& truth, const std::vector<Keyframe>& keyframes,
                                  const std::vector<PoseConstraint>& constraints) {
  std::vector<LoopError> errors;
  for (const PoseConstraint& c : constraints) {
    if (c.kind != ConstraintKind::loop) continue;
    const auto from = poseAt(truth, keyframes.at(static_cast<std::size_t>(c.from)).stamp_ns);
    const auto to = poseAt(truth, keyframes.at(static_cast<std::size_t>(c.to)).stamp_ns);
    if (!from || !to) continue;
    const Eigen::Isometry3d off = (from->inverse() * *to).inverse() * c.T_from_to;
    errors.push_back({c.from, c.to, off.translation().norm(), angleOf(off) * kDegreesPerRadian});
  }
  return errors;
}

}  // namespace pf
