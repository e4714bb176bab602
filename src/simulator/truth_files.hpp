// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "simulator/simulation.hpp"

namespace pf::simulator {

/// What is kept of a frame for the files at the end.
struct FrameRecord {
  int index = 0;
  std::int64_t stamp_ns = 0, depth_stamp_ns = 0;
  bool dropped = false;
  double exposure_ms = 0.0, gain = 0.0, smear_px = 0.0;
  std::vector<PersonTruth> people;
};
FrameRecord recordOf(const SimulatedFrame& frame);

/// 2-D and 3-D joints of all people in every frame, as JSON.
void saveJoints(const std::string& path, const std::vector<FrameRecord>& frames);

/// Falls, blurred and dropped frames, exposure, as JSON; where rooms have names, their places and
/// when the camera was in them; where things may move, when they did.
void saveEvents(const std::string& path, const Simulation& simulation,
                const std::vector<FrameRecord>& frames);

/// A mesh with materials of the world (Simulation::sceneAfter()) as triangles (PLY).
void saveSceneMesh(const std::string& path, const World& world, const Mesh& mesh);

/// The same as points about `spacing_m` apart (PLY), coloured.
void saveScenePoints(const std::string& path, const World& world, const Mesh& mesh,
                     double spacing_m);

}  // namespace pf::simulator
