// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulator/scenario.hpp"

namespace pf::simulator {

/// The scenario with all goals settled: those of people and robots that stray are drawn by the seed
/// onto free floor, and a robot that finds its way has the corners of its way as waypoints. Throws
/// InputError naming a goal that no way leads to.
Scenario settled(Scenario scenario, const World& world);

}  // namespace pf::simulator
