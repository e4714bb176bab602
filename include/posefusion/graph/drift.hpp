// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posefusion/graph/config.hpp"
#include "posefusion/graph/constraint.hpp"

namespace pf {

/// The ways between keyframes along constraints.
class Ways {
 public:
  Ways(std::size_t keyframes, const std::vector<PoseConstraint>& constraints);

  /// How many steps lie between a keyframe and each of all, by the shortest way; the number of
  /// keyframes where no way leads. Linear in the size of the graph.
  std::vector<int> stepsFrom(int keyframe) const;

 private:
  std::vector<std::vector<int>> next_;
};

/// What a pose may be off by, seen from another `reach_m` away, after so many steps of tracking
/// that each are off by odometry_sigma_m and odometry_sigma_rad: a turn anywhere on the way moves
/// its end. Of the twist (m, rad) in the camera there, the same in all directions.
Matrix6d driftCovariance(const GraphConfig& config, int steps, double reach_m);

}  // namespace pf
