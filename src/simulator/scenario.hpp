// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posefusion/core/camera.hpp"
#include "simulator/camera_path.hpp"
#include "simulator/color_config.hpp"
#include "simulator/depth_config.hpp"
#include "simulator/furniture.hpp"
#include "simulator/imu_config.hpp"
#include "simulator/legs_config.hpp"
#include "simulator/script.hpp"
#include "simulator/thing.hpp"

namespace pf::simulator {

/// What the motion capture delivers.
struct TruthConfig {
  double rate_hz = 200.0;
  double noise_m = 0.0;  ///< of the markers
  double noise_rad = 0.0;
  double gap_every_s = 0.0;  ///< markers hidden about so often; 0: never
  double gap_s = 0.3;
};

/// Everything a simulation is made from.
struct Scenario {
  std::string name;
  std::uint32_t seed = 1;
  double duration_s = 30.0;
  double start_s = 0.0;
  double fps = 30.0;
  double dropped = 0.0;  ///< part of the frames that never arrive
  std::vector<RoomSpec> rooms;
  std::vector<ObjectSpec> objects;
  std::vector<PersonSpec> people;
  std::vector<ThingSpec> things;
  bool things_move = true;  ///< false: all stay where they are at first, people do as they would
  std::optional<HandHeld> hand_held;
  std::optional<Robot> robot;
  PinholeCamera camera;
  ColorConfig color;
  DepthConfig depth;
  TruthConfig truth;
  ImuConfig imu;
  LegsConfig legs;
};

/// What the command line changes: "camera.period_s=3" sets a value of the file.
struct ScenarioChanges {
  std::vector<std::string> assignments;
  std::optional<std::uint32_t> seed;
  std::optional<double> duration_s;
  std::optional<double> start_s;
};

/// How messages and keys name an entry of a list: "people[2]".
inline std::string entryOf(const char* list, std::size_t index) {
  return std::string(list) + "[" + std::to_string(index) + "]";
}

/// Names of the scenarios that come with the package.
std::vector<std::string> scenarioNames();

/// The scenario of that name, or a scene file (a name with a dot or a slash). Throws InputError.
Scenario loadScenario(const std::string& name_or_file, const ScenarioChanges& changes = {});

}  // namespace pf::simulator
