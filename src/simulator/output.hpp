// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "simulator/simulation.hpp"

namespace pf::simulator {

/// Where simulated frames go, one after another.
class Output {
 public:
  virtual ~Output() = default;
  virtual void add(const SimulatedFrame& frame) = 0;
  /// Writes what can only be written at the end, and the truth of the frames that were added.
  virtual void finish(const Simulation& simulation) = 0;
};

/// A TUM folder: rgb/ depth/ mask/ (255 = person) person_mask/ (ids), rgb.txt depth.txt
/// associations.txt groundtruth.txt (at the rate of the motion capture) camera.yaml
/// depth_field.yaml (the true systematic error of depth) people.json joints.json events.json
/// scene.ply scene_points.ply (as at the last frame), what saveSenses() writes, and where things
/// may move thing_mask/ (1 + number of those that do) and what saveThings() writes. Throws
/// InputError naming what cannot be written.
std::unique_ptr<Output> openTumOutput(const std::string& folder, const Simulation& simulation);

}  // namespace pf::simulator
