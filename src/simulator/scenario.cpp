// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/scenario.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "posefusion/core/error.hpp"
#include "simulator/room_furniture.hpp"
#include "simulator/scenario_parts.hpp"

namespace pf::simulator {
namespace {

constexpr int kDeepestBase = 8;

bool isRobot(const YAML::Node& map) {
  return map["motion"] && map["motion"].IsScalar() && map["motion"].Scalar() == "robot";
}

/// Maps are merged key by key; a camera that becomes a robot's, or ceases to be, starts afresh;
/// everything else of `over` replaces what was there.
YAML::Node merged(const YAML::Node& under, const YAML::Node& over) {
  if (!under.IsMap() || !over.IsMap()) return YAML::Clone(over);
  if (over["motion"] && isRobot(under) != isRobot(over)) return YAML::Clone(over);
  YAML::Node result = YAML::Clone(under);
  for (const auto& entry : over) {
    const auto key = entry.first.as<std::string>();
    const YAML::Node before = under[key];
    result[key] = before ? merged(before, entry.second) : YAML::Clone(entry.second);
  }
  return result;
}

bool isFile(const std::string& name) { return name.find_first_of("./") != std::string::npos; }

YAML::Node loadTree(const std::string& name, const std::string& beside, int depth) {
  if (depth > kDeepestBase) throw InputError(name + ": base leads back to itself");
  std::string text;
  std::string path = name;
  if (isFile(name)) {
    if (name[0] != '/' && !beside.empty()) path = beside + name;
    std::ifstream in(path);
    if (!in)
      throw InputError(path + ": cannot be read, expected a scene file or one of " + joinedNames());
    text.assign(std::istreambuf_iterator<char>(in), {});
  } else {
    text = scenarioText(name);
  }
  YAML::Node tree = parseYaml(text, path);
  if (!tree.IsMap()) throw InputError(path + ": expected keys with values");
  const YAML::Node base = tree["base"];
  if (!base) return tree;
  if (!base.IsScalar()) throw InputError(path + ": base is not a name or file of a scene");
  const std::string folder = path.substr(0, path.find_last_of('/') + 1);
  YAML::Node whole = merged(loadTree(base.as<std::string>(), folder, depth + 1), tree);
  whole.remove("base");
  return whole;
}

/// Sets "a.b.0.c=value" in a tree.
void assign(YAML::Node tree, const std::string& assignment) {
  const auto equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError("--set " + assignment + ": expected KEY=VALUE, as in camera.period_s=3");
  }
  const std::string value = assignment.substr(equals + 1);
  std::string path = assignment.substr(0, equals);
  YAML::Node node = tree;
  for (;;) {
    const auto dot = path.find('.');
    const std::string key = path.substr(0, dot);
    YAML::Node next;
    if (node.IsSequence()) {
      const bool digits = !key.empty() && key.find_first_not_of("0123456789") == std::string::npos;
      if (!digits || std::stoul(key) >= node.size()) {
        throw InputError("--set " + assignment + ": '" + key + "' is no entry of the list");
      }
      next.reset(node[std::stoul(key)]);
    } else if (node.IsScalar()) {
      throw InputError("--set " + assignment + ": '" + key + "' is within a single value");
    } else {
      next.reset(node[key]);
    }
    if (dot == std::string::npos) {
      next = parseYaml(value, "--set " + assignment);
      return;
    }
    path = path.substr(dot + 1);
    node.reset(next);
  }
}

void readTruth(YamlMap map, TruthConfig& truth) {
  truth.rate_hz = map.number("rate_hz", truth.rate_hz, 1.0, 2000.0);
  truth.noise_m = map.number("noise_m", truth.noise_m, 0.0, 1.0);
  truth.noise_rad = map.number("noise_rad", truth.noise_rad, 0.0, 1.0);
  truth.gap_every_s = map.number("gap_every_s", truth.gap_every_s, 0.0, 1e4);
  truth.gap_s = map.number("gap_s", truth.gap_s, 0.0, 100.0);
  map.finish();
}

void readImu(YamlMap map, ImuConfig& imu) {
  imu.camera_m = map.vector3("camera_m", imu.camera_m);
  imu.camera_rpy_rad =
      map.vector3("camera_rpy_deg", imu.camera_rpy_rad * 180.0 / M_PI) * M_PI / 180.0;
  YamlFields fields(map);
  visitFields(imu, fields);
  fields.finish();
}

/// Rooms and what stands in them, that of the file first.
void readPlaces(YamlMap& map, Scenario& s) {
  for (auto& room : map.maps("rooms")) {
    const auto index = static_cast<std::uint32_t>(s.rooms.size());
    s.rooms.push_back(readRoom(room, s.rooms, hash(s.seed, 47U, index)));
  }
  if (s.rooms.empty()) map.fail("rooms", "is missing or empty, expected at least one room");
  for (auto& object : map.maps("objects")) {
    s.objects.push_back(
        readObject(object, hash(s.seed, 41U, static_cast<std::uint32_t>(s.objects.size()))));
  }
  for (const auto& room : s.rooms) {
    for (auto& thing : furnish(room)) s.objects.push_back(std::move(thing));
  }
}

}  // namespace

Scenario loadScenario(const std::string& name_or_file, const ScenarioChanges& changes) {
  YAML::Node tree = loadTree(name_or_file, "", 0);
  for (const auto& assignment : changes.assignments) assign(tree, assignment);
  if (changes.duration_s) tree["duration_s"] = *changes.duration_s;
  if (changes.start_s) tree["start_s"] = *changes.start_s;
  YamlMap map(tree, name_or_file + ": ");
  Scenario s;
  s.name = map.text("name", name_or_file);
  map.text("about", "");
  s.seed = static_cast<std::uint32_t>(map.integer("seed", 1, 0, 1000000000));
  s.duration_s = map.number("duration_s", s.duration_s, 0.05, 36000.0);
  s.start_s = map.number("start_s", s.start_s, 0.0, 36000.0);
  if (changes.seed) s.seed = *changes.seed;
  s.fps = map.number("fps", s.fps, 0.5, 240.0);
  s.dropped = map.number("dropped", s.dropped, 0.0, 0.9);
  readPlaces(map, s);
  for (auto& thing : map.maps("things")) {
    const auto index = static_cast<std::uint32_t>(s.things.size());
    s.things.push_back(readThing(thing, s.things, hash(s.seed, 42U, index)));
  }
  if (s.things.size() > kMostThings) map.fail("things", "has more than 150 entries");
  s.things_move = map.flag("things_move", s.things_move);
  for (auto& person : map.maps("people")) {
    const auto index = static_cast<std::uint32_t>(s.people.size());
    s.people.push_back(readPerson(person, hash(s.seed, 43U, index), s.things));
  }
  if (s.people.size() > kMostPeople) map.fail("people", "has more than 30 entries");
  readCamera(map.map("camera"), s);
  YamlFields color(map.map("color")), depth(map.map("depth")), legs(map.map("legs"));
  visitFields(s.color, color);
  visitFields(s.legs, legs);
  visitFields(s.depth, depth);
  if (!tree["depth"] || !tree["depth"]["specimen"]) {
    s.depth.specimen = static_cast<int>(s.seed % 1000001U);
  }
  if (s.depth.min_m >= s.depth.max_m) map.fail("depth.min_m", "is not less than max_m");
  color.finish();
  depth.finish();
  legs.finish();
  readImu(map.map("imu"), s.imu);
  readTruth(map.map("truth"), s.truth);
  map.finish();
  return s;
}

}  // namespace pf::simulator
