// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "simulator/outfit.hpp"
#include "simulator/rig.hpp"

namespace pf::simulator {

/// One thing a person does. Walking finds its own way round the furniture.
struct Action {
  enum class Kind { walk, stand, talk, sit, reach, crouch, take, put, push, swing };
  Kind kind = Kind::stand;
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();  ///< goal; seat; for the hand; put: there
  double yaw_rad = 0.0;                            ///< facing there (world); put: of the thing
  bool turns = false;                              ///< whether yaw_rad is given
  double for_s = 2.0;                              ///< all but walk; swing: of the thing
  double speed_m_s = 1.0;                          ///< walk, push
  double seat_m = 0.45;                            ///< height of the seat
  bool carries = false;                            ///< walk: with a box in both hands
  bool gestures = false;                           ///< sit: hands talk too
  std::size_t thing = 0;                           ///< take, put, push, swing: number of the thing
  std::vector<Eigen::Vector3d> path_m;             ///< push: of the thing
  double turn_rad = 0.0;                           ///< swing: about its hinge
};

/// A person of a scene file.
struct PersonSpec {
  std::string name;
  Build build;
  Outfit outfit;
  Eigen::Vector2d start_m = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;
  std::vector<Action> script;  ///< empty: stands
  bool repeats = true;
  double stray_m = 0.0;  ///< by the seed, start and goals of walking; see settled()
  double delay_s = 0.0;  ///< before the first action
};

}  // namespace pf::simulator
