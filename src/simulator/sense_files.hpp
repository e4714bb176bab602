// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "simulator/simulation.hpp"

namespace pf::simulator {

/// Writes what the robot's other sensors say while the first `frames` frames are taken: imu.csv
/// imu.yaml (as of EuRoC), odometry.txt base_camera.txt (TUM format), head_joints.csv. Throws
/// InputError naming what cannot be written.
void saveSenses(const std::string& folder, const Simulation& simulation, int frames);

}  // namespace pf::simulator
