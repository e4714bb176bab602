// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "simulator/scenario.hpp"
#include "simulator/simulation.hpp"
#include "temporary_folder.hpp"

namespace pf::simulator {

/// A small room with a table, a walker and a seated talker, small pictures: quick to build and
/// draw.
inline const char* smallScene() {
  return R"(
duration_s: 1.0
rooms: [{size_m: [5, 4, 2.6], lamps: [1, 1], floor: wood}]
objects:
  - {kind: table, at_m: [3.2, 2.9]}
  - {kind: poster, at_m: [5.0, 2.0, 1.0], yaw_deg: 180}
  - {kind: shelf, at_m: [4.8, 0.8], yaw_deg: 180}
people:
  - {name: walker, look: 3, start_m: [2.6, 1.2], yaw_deg: 90, script: [{do: walk, to: [2.45, 2.6]}]}
  - {name: sitter, look: 4, start_m: [3.5, 1.0], script: [{do: sit, on: [3.6, 1.2], yaw_deg: 170, talks: true, for_s: 60}]}
camera: {motion: xyz, at_m: [0.7, 1.9, 1.3], look_at_m: [3.5, 1.9, 0.9], width: 160}
depth: {offset_ms: 0, jitter_ms: 0}
)";
}

inline Scenario load(const std::string& text, const ScenarioChanges& changes = {}) {
  const TemporaryFolder folder;
  return loadScenario(folder.write("scene.yaml", text), changes);
}

inline Scenario smallScenario(const std::vector<std::string>& assignments = {}) {
  ScenarioChanges changes;
  changes.assignments = assignments;
  return load(smallScene(), changes);
}

}  // namespace pf::simulator
