// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulator/random.hpp"
#include "simulator/world.hpp"

namespace pf::simulator {

/// Where a person can sit: middle of the seat's front half over the floor, direction of the knees,
/// height.
struct Seat {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;
  double height_m = 0.45;
};

/// Where a person can lie: the middle, direction of the long side, height.
struct Bed {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;
  double height_m = 0.45;
};

/// A random furnished room for depth alone (plain surfaces, no light).
struct PersonRoom {
  World world;
  Eigen::Vector3d size_m;  ///< low corner at the origin
  std::vector<Seat> seats;
  std::vector<Bed> beds;
};

/// Furniture along the walls, tables with chairs around, and things that a depth camera takes for
/// bodies: coat racks, plants, lamps, chairs with slats and tilted backs, stacks of boxes, bags.
PersonRoom drawRoom(Dice& dice);

}  // namespace pf::simulator
