// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulator/random.hpp"
#include "simulator/rig.hpp"

namespace pf::simulator {

/// What postures of scripted actions lack: turns arms about shoulders and elbows, bends the trunk,
/// turns the head, and moves the legs too where `legs` (of a person that does not stand on them).
void loosen(const Rig& rig, Posture& posture, bool legs, Dice& dice);

/// The whole body moved.
void moveBody(const Eigen::Isometry3f& motion, Posture& posture);

/// Lays a standing body down: on its back, front or side by dice, lowest joint about a limb's
/// radius above `floor_m`, its middle over the origin.
void layDown(const Rig& rig, float floor_m, Dice& dice, Posture& posture);

/// Tilts a body as in a fall, lowest joint a little above the floor.
void topple(const Rig& rig, float angle_rad, Dice& dice, Posture& posture);

}  // namespace pf::simulator
