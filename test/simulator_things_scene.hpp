// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "simulator_scene.hpp"

namespace pf::simulator {

/// Numbers of the things of thingsScene().
enum SceneThing : std::size_t { kParcel, kChair, kDoor, kTrolley, kStool };

/// A room where a person carries a parcel to a table and pushes a chair; a door swings, a trolley
/// rolls while it is seen, and a stool moves while it is not: the camera looks to the east, and for
/// some seconds to the north.
inline const char* thingsScene() {
  return R"(
duration_s: 22
fps: 5
rooms: [{size_m: [5, 4, 2.6], lamps: [1, 1], floor: wood}]
objects:
  - {kind: table, at_m: [4.4, 3.2], size_m: [0.8, 1.2, 0.73]}
  - {kind: poster, at_m: [5.0, 2.0, 1.0], yaw_deg: 180}
things:
  - {name: parcel, kind: box, size_m: [0.3, 0.36, 0.26], at_m: [3.6, 1.4], yaw_deg: 15}
  - {name: chair, kind: office_chair, at_m: [2.6, 3.0], yaw_deg: 200}
  - name: door
    kind: partition
    size_m: [0.045, 0.8, 2.0]
    at_m: [4.92, 1.0]
    yaw_deg: 180
    hinge_m: [0, 0.4]
    moves: [{at_s: 1, over_s: 1.5, turn_deg: 80}]
  - name: trolley
    kind: trolley
    at_m: [4.2, 0.5]
    yaw_deg: 180
    moves: [{at_s: 13, when: seen, over_s: 3, path: [[3.6, 0.6], [3.0, 0.5]], turn_deg: 10}]
  - name: stool
    kind: stool
    at_m: [3.0, 2.2]
    moves: [{at_s: 2, when: unseen, over_s: 1, to: [3.1, 1.2], turn_deg: 30}]
people:
  - name: anna
    look: 3
    start_m: [3.8, 2.2]
    yaw_deg: 180
    repeats: false
    script:
      - {do: take, thing: parcel}
      - {do: put, at: [4.25, 3.2, 0.73], yaw_deg: 10}
      - {do: push, thing: chair, path: [[2.4, 3.2]]}
      - {do: stand, for_s: 60}
camera:
  motion: robot
  height_m: 1.3
  turn_deg_s: 40
  speed_m_s: 0.3
  pause_s: 2
  repeats: false
  waypoints: [[0.7, 1.9, 0], [0.8, 1.9, 0], [0.8, 2.0, 95], [0.8, 1.9, 0], [0.7, 1.9, 0]]
  width: 160
color: {motion_blur: false, samples: 1}
depth: {offset_ms: 0, jitter_ms: 0, noise: false, distortion: 0}
)";
}

inline Scenario thingsScenario(const std::vector<std::string>& assignments = {}) {
  ScenarioChanges changes;
  changes.assignments = assignments;
  return load(thingsScene(), changes);
}

}  // namespace pf::simulator
