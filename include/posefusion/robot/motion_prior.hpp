// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "posefusion/core/se3.hpp"

namespace pf {

/// The camera's motion between two moments, measured by another sensor of the robot.
struct MotionPrior {
  Eigen::Isometry3d T_before_after = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< of the twist (m, rad) in the later camera's frame
  bool has_shift = false;                  ///< else only the rotation is measured
};

/// A robot that walks (1 m/s) and turns (1 rad/s) does so with these root mean squares, and for
/// some time into the same direction: what it may do where nothing measures it.
constexpr double kRobotSpeed_m_s = 0.6, kRobotTurn_rad_s = 1.2;

/// Combines the motions of two independent sources. Nothing where they contradict each other: by a
/// chi-square of 22.46 (1 in 1000 by chance).
std::optional<MotionPrior> combined(const MotionPrior& a, const MotionPrior& b);

}  // namespace pf
