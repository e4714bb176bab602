// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "new_bag.hpp"
#include "simulator/simulation.hpp"

namespace pf {

/// Writes what the robot's other sensors say while the first `frames` frames are taken: /imu/data,
/// /odom with covariances, /joint_states of the neck, and /tf from `odom` by `base_link` to the
/// camera and its `imu_link`.
void writeSenses(const simulator::Simulation& simulation, int frames, NewBag& bag);

}  // namespace pf
