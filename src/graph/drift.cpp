// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/graph/drift.hpp"

#include <cmath>

namespace pf {

Ways::Ways(std::size_t keyframes, const std::vector<PoseConstraint>& constraints)
    : next_(keyframes) {
  for (const PoseConstraint& c : constraints) {
    next_[static_cast<std::size_t>(c.from)].push_back(c.to);
    next_[static_cast<std::size_t>(c.to)].push_back(c.from);
  }
}

std::vector<int> Ways::stepsFrom(int keyframe) const {
  std::vector<int> steps(next_.size(), static_cast<int>(next_.size()));
  steps[static_cast<std::size_t>(keyframe)] = 0;
  std::vector<int> order = {keyframe};
  for (std::size_t i = 0; i < order.size(); ++i) {
    const int so_far = steps[static_cast<std::size_t>(order[i])];
    for (const int other : next_[static_cast<std::size_t>(order[i])]) {
      int& there = steps[static_cast<std::size_t>(other)];
      if (there <= so_far + 1) continue;
      there = so_far + 1;
      order.push_back(other);
    }
  }
  return steps;
}

Matrix6d driftCovariance(const GraphConfig& config, int steps, double reach_m) {
  // Turns spread evenly over the way move its end by a third of what one at its beginning does.
  const double turned_m = config.odometry_sigma_rad * reach_m / std::sqrt(3.0);
  return steps * independentCovariance(std::hypot(config.odometry_sigma_m, turned_m),
                                       config.odometry_sigma_rad);
}

}  // namespace pf
