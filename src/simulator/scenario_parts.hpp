// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/config/yaml_map.hpp"
#include "simulator/random.hpp"
#include "simulator/scenario.hpp"

namespace pf::simulator {

/// The scene file of a scenario of the package. Throws InputError for an unknown name.
std::string scenarioText(const std::string& name);

/// All names, for messages.
std::string joinedNames();

/// A room that is `like` another one begins as a copy of it, which has to be among those `before`.
RoomSpec readRoom(YamlMap& map, const std::vector<RoomSpec>& before, std::uint32_t seed);
ObjectSpec readObject(YamlMap& map, std::uint32_t seed);
PersonSpec readPerson(YamlMap& map, std::uint32_t seed);

/// The lens and the motion of the camera, into the scenario.
void readCamera(YamlMap map, Scenario& scenario);

}  // namespace pf::simulator
