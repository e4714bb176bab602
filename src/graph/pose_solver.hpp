// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "posefusion/graph/config.hpp"
#include "posefusion/graph/constraint.hpp"

namespace pf {

/// Fits the poses (T_map_camera of each keyframe) to the constraints: least squares of the whitened
/// errors, loops with Cauchy loss. Poses that are `fixed`, and those of no constraint, stay.
/// Returns false, with the poses as they were, when the solver failed.
bool solvePoses(const GraphConfig& config, const std::vector<PoseConstraint>& constraints,
                const std::vector<bool>& fixed, std::vector<Eigen::Isometry3d>& poses);

/// The same with a weight for each constraint in place of the Cauchy loss.
bool solvePoses(const GraphConfig& config, const std::vector<PoseConstraint>& constraints,
                const std::vector<double>& weights, const std::vector<bool>& fixed,
                std::vector<Eigen::Isometry3d>& poses);

}  // namespace pf
