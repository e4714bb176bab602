// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulator/avatar.hpp"
#include "simulator/person_room.hpp"
#include "simulator/posed_movers.hpp"
#include "simulator/walkway.hpp"

namespace pf::simulator {

/// Some people of all builds.
std::vector<Avatar> drawCast(int count, Dice& dice);

/// People at one moment.
struct Arrangement {
  Postures postures;                                ///< absent people are far below the floor
  std::vector<char> present;                        ///< of each
  Eigen::Vector3d focus = Eigen::Vector3d::Zero();  ///< worth looking at
  std::vector<Eigen::Vector2d> others;  ///< where the people beside the one in focus are
};

/// No person (sometimes) up to all of the cast, close together or apart: walking, standing,
/// talking, reaching, seated, crouching, lying, falling.
Arrangement arrange(const PersonRoom& room, const Walkway& walkway, const std::vector<Avatar>& cast,
                    Dice& dice);

}  // namespace pf::simulator
