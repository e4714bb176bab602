// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulator/random.hpp"
#include "simulator/scenario.hpp"
#include "simulator/yaml_map.hpp"

namespace pf::simulator {

RoomSpec readRoom(YamlMap& map);
ObjectSpec readObject(YamlMap& map, std::uint32_t seed);
PersonSpec readPerson(YamlMap& map, std::uint32_t seed);

/// The lens and the motion of the camera, into the scenario.
void readCamera(YamlMap map, Scenario& scenario);

}  // namespace pf::simulator
