// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulator/scenario.hpp"
#include "simulator/world.hpp"

namespace pf::simulator {

/// Throws InputError, naming the entry of the scene file and the place, for things outside of all
/// rooms, and for people who begin or are sent where nobody can stand.
void checkScene(const Scenario& scenario, const World& world);

}  // namespace pf::simulator
