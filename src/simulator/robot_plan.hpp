// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulator/camera_path.hpp"

namespace pf::simulator {

// Phases of a fall before it drops and after it has lain.
constexpr double kStagger_s = 0.45;
constexpr double kGetUp_s = 2.6;

/// Where a robot stands and where it faces.
struct Place {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double yaw = 0.0;
  double floor_m = 0.0;
};

/// A piece of the robot's time.
struct Piece {
  enum class Kind { walk, turn, pause, fall } kind = Kind::pause;
  double start_s = 0.0;
  double length_s = 0.0;
  Place from, to;
  Fall fall;
  double steps_before = 0.0;  ///< counted over walking and turning
};

/// What the robot does when: walks to its waypoints, turns on the spot, pauses, falls.
std::vector<Piece> planRobot(const Robot& spec, double duration_s);

}  // namespace pf::simulator
