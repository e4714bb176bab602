// SPDX-License-Identifier: BSD-3-Clause
// Things that may move, in a scene file, and what people do with them.
#include <algorithm>
#include <cmath>
#include <optional>

#include "simulator/scenario_parts.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector3d;

/// The places of a thing's way; z NaN where it is not given.
std::vector<Vector3d> readPath(YamlMap& map) {
  if (!map.has("to")) return map.places("path");
  if (map.has("path")) map.fail("path", "is given beside to, expected one of them");
  return {readPlace(map, "to", std::nan(""))};
}

ThingMove readMove(YamlMap& map) {
  ThingMove move;
  move.at_s = map.number("at_s", move.at_s, 0.0, 36000.0);
  move.over_s = map.number("over_s", move.over_s, 0.1, 3600.0);
  const std::string when = map.word("when", "time", {"time", "seen", "unseen"});
  if (when == "seen") move.when = ThingMove::When::seen;
  if (when == "unseen") move.when = ThingMove::When::unseen;
  move.path_m = readPath(map);
  move.turn_rad = map.angle("turn_deg", 0.0);
  if (move.path_m.empty() && move.turn_rad == 0.0) {
    map.fail("to", "is missing, expected to, path or turn_deg");
  }
  map.finish();
  return move;
}

std::size_t readThingName(YamlMap& map, const std::vector<ThingSpec>& things) {
  std::vector<std::string> names;
  for (const ThingSpec& thing : things) names.push_back(thing.name);
  const std::string name = map.word("thing", "", names);
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

}  // namespace

ThingSpec readThing(YamlMap& map, const std::vector<ThingSpec>& before, std::uint32_t seed) {
  ThingSpec thing;
  thing.name = map.text("name", "");
  if (thing.name.empty()) map.fail("name", "is missing, expected what the scripts call it");
  for (const ThingSpec& other : before) {
    if (other.name == thing.name) {
      map.fail("name", "is '" + thing.name + "', as that of a thing before");
    }
  }
  thing.object = readObjectFields(map, seed);
  if (thing.object.kind == "window") map.fail("kind", "is 'window', expected one without light");
  thing.hinge_m = map.vector2("hinge_m", thing.hinge_m);
  for (auto& entry : map.maps("moves")) {
    const ThingMove move = readMove(entry);
    if (!thing.moves.empty() && move.at_s < thing.moves.back().at_s + thing.moves.back().over_s) {
      entry.fail("at_s", "is before the move before has ended");
    }
    thing.moves.push_back(move);
  }
  map.finish();
  return thing;
}

void readThingAction(YamlMap& map, Action::Kind kind, const std::vector<ThingSpec>& things,
                     Action& action) {
  action.kind = kind;
  if (kind == Action::Kind::put) {
    action.at_m = readPlace(map, "at", 0.0);
    action.turns = map.has("yaw_deg");
    action.yaw_rad = map.angle("yaw_deg", 0.0);
  } else {
    action.thing = readThingName(map, things);
  }
  if (kind == Action::Kind::push) {
    action.path_m = readPath(map);
    if (action.path_m.empty()) map.fail("to", "is missing, expected to or path");
    action.speed_m_s = map.number("speed_m_s", 0.6, 0.1, 2.0);
  }
  if (kind == Action::Kind::swing) {
    action.turn_rad = map.angle("turn_deg", 80.0 * M_PI / 180.0);
    action.for_s = map.number("over_s", 2.0, 0.2, 60.0);
    if (things[action.thing].hinge_m.isZero()) map.fail("thing", "has no hinge_m to swing about");
  }
  map.finish();
}

void settleHands(const YamlMap& map, PersonSpec& person) {
  std::optional<std::size_t> held;
  for (std::size_t i = 0; i < person.script.size(); ++i) {
    Action& action = person.script[i];
    const std::string key = "script[" + std::to_string(i) + "]";
    if (action.kind == Action::Kind::put) {
      if (!held) map.fail(key, "puts down what nobody took");
      action.thing = *held;
      held.reset();
      continue;
    }
    const bool needs_hands = action.kind > Action::Kind::talk || action.carries;
    if (held && needs_hands) map.fail(key, "needs free hands, expected put before it");
    if (action.kind == Action::Kind::take) held = action.thing;
  }
  if (held && person.repeats && !person.script.empty()) {
    map.fail("script", "repeats with something in the hands, expected put, or repeats: false");
  }
}

}  // namespace pf::simulator
