// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/things_file.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "posefusion/core/error.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/trajectory_file.hpp"

namespace pf {
namespace {

Eigen::Isometry3d poseOf(const nlohmann::json& json) {
  const auto at = json.at("at_m").get<std::vector<double>>();
  if (at.size() != 3) throw InputError("at_m has " + std::to_string(at.size()) + " numbers, not 3");
  const double yaw = json.at("yaw_deg").get<double>() * M_PI / 180.0;
  Eigen::Isometry3d T(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  T.translation() << at[0], at[1], at[2];
  return T;
}

RecordedThing thingOf(const nlohmann::json& json) {
  RecordedThing thing;
  thing.name = json.at("name").get<std::string>();
  for (const auto& move : json.at("moves")) {
    thing.moves.push_back({parseStamp(move.at("begin").get<std::string>()),
                           parseStamp(move.at("end").get<std::string>()), poseOf(move.at("from")),
                           poseOf(move.at("to"))});
  }
  return thing;
}

}  // namespace

std::vector<RecordedThing> loadThings(const std::string& sequence) {
  const std::string path = sequence + "/events.json";
  std::vector<RecordedThing> things;
  try {
    const auto root = nlohmann::json::parse(readFile(path));
    if (!root.contains("things")) {
      throw InputError("has no things, expected a recording of a scene with movable things");
    }
    for (const auto& thing : root.at("things")) things.push_back(thingOf(thing));
  } catch (const nlohmann::json::exception& error) {
    throw InputError(path + ": " + error.what());
  } catch (const InputError& error) {
    throw InputError(path + ": " + error.what());
  }
  for (std::size_t i = 0; i < things.size(); ++i) {
    const std::string file = sequence + "/things/" + std::to_string(i + 1);
    things[i].poses = loadTrajectory(file + ".txt");
    things[i].points = loadPoints(file + ".ply");
  }
  return things;
}

}  // namespace pf
