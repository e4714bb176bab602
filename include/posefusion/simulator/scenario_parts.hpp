// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/simulator/random.hpp"
#include "posefusion/simulator/scenario.hpp"
#include "posefusion/simulator/yaml_map.hpp"

namespace posefusion::simulator {

RoomSpec readRoom(YamlMap& map);
ObjectSpec readObject(YamlMap& map, std::uint32_t seed);
PersonSpec readPerson(YamlMap& map, std::uint32_t seed);

/// The lens and the motion of the camera, into the scenario.
void readCamera(YamlMap map, Scenario& scenario);

}  // namespace posefusion::simulator
