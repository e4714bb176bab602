// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "simulator/simulation.hpp"

namespace pf::simulator {

/// What became of the things in the time of so many frames, as events.json has it.
nlohmann::ordered_json thingsJson(const Simulation& simulation, int frames);

/// Into `folder`/things: the poses of each thing (NUMBER.txt, TUM trajectory of T_world_thing, to
/// be interpolated), its surface in its own frame (NUMBER.ply, points) and the still world without
/// any thing (room_points.ply).
void saveThings(const std::string& folder, const Simulation& simulation, int frames);

}  // namespace pf::simulator
