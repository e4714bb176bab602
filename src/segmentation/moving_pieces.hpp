// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "posefusion/segmentation/moving_objects.hpp"

namespace pf {

/// A connected piece of depth that may be a moving object.
struct MovingObjects::Piece {
  std::vector<int> cells;
  int seeds = 0;
  double area_m2 = 0;
  std::array<int, SeenBefore::kAges_s.size()> was_free{}, was_there{};
  std::vector<int> votes;  ///< cells that each object was expected in
};

/// An object from frame to frame.
struct MovingObjects::Followed {
  MovingObject object;
  double odds = 0;         ///< for moving, in frames (at 30 Hz) of evidence; given up at 0
  double unseen_s = 0;     ///< since it was last found
  std::vector<int> cells;  ///< of the grid, in the newest frame
};

}  // namespace pf
