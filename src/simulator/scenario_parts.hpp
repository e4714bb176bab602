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

/// A place of two or three numbers.
Eigen::Vector3d readPlace(YamlMap& map, const std::string& key, double otherwise_z);

/// A room that is `like` another one begins as a copy of it, which has to be among those `before`.
RoomSpec readRoom(YamlMap& map, const std::vector<RoomSpec>& before, std::uint32_t seed);
ObjectSpec readObject(YamlMap& map, std::uint32_t seed);
/// The same for a map that has other keys too.
ObjectSpec readObjectFields(YamlMap& map, std::uint32_t seed);
PersonSpec readPerson(YamlMap& map, std::uint32_t seed, const std::vector<ThingSpec>& things);

/// A thing that may move, with a name that none of those `before` has.
ThingSpec readThing(YamlMap& map, const std::vector<ThingSpec>& before, std::uint32_t seed);
/// The rest of an action of one of these kinds.
void readThingAction(YamlMap& map, Action::Kind kind, const std::vector<ThingSpec>& things,
                     Action& action);
/// Fills in what is put down. Throws where hands are not free for what is done, or not free in the
/// end of a script that repeats.
void settleHands(const YamlMap& map, PersonSpec& person);

/// The lens and the motion of the camera, into the scenario.
void readCamera(YamlMap map, Scenario& scenario);

}  // namespace pf::simulator
