// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/thing_files.hpp"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "posefusion/core/stamps.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "simulator/truth_files.hpp"

namespace pf::simulator {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kThingSpacing_m = 0.015, kRoomSpacing_m = 0.03;  // of points

double rounded(double value) { return std::round(value * 1e4) / 1e4; }

Json listOf(const Eigen::Vector3d& v) { return {rounded(v.x()), rounded(v.y()), rounded(v.z())}; }

Json poseJson(const ThingPose& pose) {
  const double yaw = std::remainder(pose.yaw_rad, 2.0 * M_PI) * 180.0 / M_PI;
  return {{"at_m", listOf(pose.at_m)}, {"yaw_deg", rounded(yaw)}};
}

Json changeJson(const ThingChange& change, const Simulation& simulation) {
  Json json = {{"begin", formatStamp(simulation.stampOf(change.begin_s))},
               {"end", formatStamp(simulation.stampOf(change.end_s))},
               {"from", poseJson(change.from)},
               {"to", poseJson(change.to)}};
  if (change.mover >= 0) {
    json["by"] = simulation.scenario().people[static_cast<std::size_t>(change.mover)].name;
  }
  if (!change.is_over) json["is_over"] = false;
  return json;
}

}  // namespace

Json thingsJson(const Simulation& simulation, int frames) {
  Json things = Json::array();
  const auto changes = simulation.thingChanges(frames);
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const ThingSpec& spec = simulation.scenario().things[i];
    const Eigen::AlignedBox3d& box = simulation.things()[i].box;
    Json moves = Json::array();
    for (const ThingChange& change : changes[i]) moves.push_back(changeJson(change, simulation));
    things.push_back({{"id", i + 1},
                      {"name", spec.name},
                      {"kind", spec.object.kind},
                      {"low_m", listOf(box.min())},
                      {"high_m", listOf(box.max())},
                      {"moves", moves}});
  }
  return things;
}

void saveThings(const std::string& folder, const Simulation& simulation, int frames) {
  const std::filesystem::path things = std::filesystem::path(folder) / "things";
  makeFolder(things);
  const World& world = simulation.world();
  for (std::size_t i = 0; i < simulation.things().size(); ++i) {
    const std::string number = std::to_string(i + 1);
    saveTrajectory(things / (number + ".txt"), simulation.thingPoses(i, frames),
                   "thing to world, " + simulation.scenario().things[i].name);
    saveScenePoints(things / (number + ".ply"), world, simulation.things()[i].mesh,
                    kThingSpacing_m);
  }
  saveScenePoints(things / "room_points.ply", world, world.mesh, kRoomSpacing_m);
}

}  // namespace pf::simulator
