// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/scenario_parts.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "simulator/room_furniture.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Action readAction(YamlMap& map, const std::vector<ThingSpec>& things) {
  Action a;
  const std::string what = map.word(
      "do", "stand",
      {"walk", "carry", "stand", "talk", "sit", "reach", "crouch", "take", "put", "push", "swing"});
  static const std::map<std::string, Action::Kind> with_thing = {{"take", Action::Kind::take},
                                                                 {"put", Action::Kind::put},
                                                                 {"push", Action::Kind::push},
                                                                 {"swing", Action::Kind::swing}};
  if (const auto kind = with_thing.find(what); kind != with_thing.end()) {
    readThingAction(map, kind->second, things, a);
    return a;
  }
  if (what == "walk" || what == "carry") {
    a.kind = Action::Kind::walk;
    a.carries = what == "carry";
    a.at_m.head<2>() = readPlace(map, "to", 0.0).head<2>();
    a.speed_m_s = map.number("speed_m_s", a.carries ? 0.8 : 1.0, 0.1, 2.5);
    map.finish();
    return a;
  }
  a.for_s = map.number("for_s", 3.0, 0.0, 36000.0);
  a.turns = map.has("yaw_deg");
  a.yaw_rad = map.angle("yaw_deg", 0.0);
  if (what == "talk") a.kind = Action::Kind::talk;
  if (what == "crouch") a.kind = Action::Kind::crouch;
  if (what == "sit") {
    a.kind = Action::Kind::sit;
    a.at_m = readPlace(map, "on", 0.0);
    a.seat_m = map.number("seat_m", 0.45, 0.2, 1.0);
    a.gestures = map.flag("talks", false);
  }
  if (what == "reach") {
    a.kind = Action::Kind::reach;
    a.at_m = readPlace(map, "at", 1.3);
  }
  map.finish();
  return a;
}

Robot readRobot(YamlMap& map) {
  Robot r;
  for (const Vector3d& place : map.places("waypoints")) {
    r.waypoints.emplace_back(place.x(), place.y());
    if (!std::isnan(place.z())) r.waypoints.back().facing_rad = place.z() * M_PI / 180.0;
  }
  if (r.waypoints.empty()) map.fail("waypoints", "is missing, expected [[x, y], ...]");
  r.finds_way = map.flag("finds_way", r.finds_way);
  r.stray_m = map.number("stray_m", r.stray_m, 0.0, 10.0);
  if (r.stray_m > 0.0 && !r.finds_way) map.fail("stray_m", "needs finds_way: true");
  r.repeats = map.flag("repeats", r.repeats);
  r.turns_body = !map.has("look_at_m");
  r.target = map.vector3("look_at_m", r.target);
  r.height_m = map.number("height_m", r.height_m, 0.3, 2.2);
  r.floor_m = map.number("floor_m", r.floor_m, 0.0, 10.0);
  r.pitch_rad = map.angle("pitch_deg", r.pitch_rad);
  r.speed_m_s = map.number("speed_m_s", r.speed_m_s, 0.02, 2.0);
  r.turn_rad_s = map.angle("turn_deg_s", r.turn_rad_s);
  if (r.turn_rad_s < 0.01) map.fail("turn_deg_s", "is too small, expected 1 or more");
  r.step_s = map.number("step_s", r.step_s, 0.2, 3.0);
  r.sway_m = map.number("sway_m", r.sway_m, 0.0, 0.2);
  r.bounce_m = map.number("bounce_m", r.bounce_m, 0.0, 0.2);
  r.jerk = map.number("jerk", r.jerk, 0.0, 10.0);
  r.pause_s = map.number("pause_s", r.pause_s, 0.0, 100.0);
  for (auto& entry : map.maps("falls")) {
    Fall fall;
    fall.at_s = entry.number("at_s", 10.0, 0.0, 36000.0);
    if (!r.falls.empty() && fall.at_s <= r.falls.back().at_s) {
      entry.fail("at_s", "is not after the fall before");
    }
    fall.direction = entry.word("to", "forward", {"forward", "backward", "sideways"});
    fall.lie_s = entry.number("lie_s", 3.0, 0.0, 60.0);
    fall.skip_m = entry.number("skip_m", 1.0, 0.0, 20.0);
    fall.turn_rad = entry.angle("turn_deg", 45.0 * M_PI / 180.0);
    fall.down_m = entry.number("down_m", fall.down_m, -10.0, 10.0);
    fall.ahead_m = entry.number("ahead_m", fall.ahead_m, 0.0, 10.0);
    fall.drop_s = entry.number("drop_s", fall.drop_s, 0.2, 10.0);
    fall.bumps = entry.integer("bumps", fall.bumps, 0, 100);
    entry.finish();
    r.falls.push_back(fall);
  }
  return r;
}

void readFurniture(YamlMap map, Furniture& furniture) {
  furniture.style = map.word("style", furniture.style, furnitureStyles());
  furniture.seed = static_cast<std::uint32_t>(
      map.integer("seed", static_cast<int>(furniture.seed % 1000000001U), 0, 1000000000));
  map.finish();
}

/// A room as new, or as the one that it is like, with its own name.
RoomSpec readLike(YamlMap& map, const std::vector<RoomSpec>& before, std::uint32_t seed) {
  const auto find = [&](const std::string& name) {
    return std::find_if(before.begin(), before.end(),
                        [&](const RoomSpec& room) { return room.name == name; });
  };
  RoomSpec r;
  r.furniture.seed = seed;
  const std::string name = map.text("name", ""), like = map.text("like", "");
  if (!name.empty() && find(name) != before.end()) {
    map.fail("name", "is '" + name + "', as that of a room before");
  }
  if (!like.empty()) {
    if (find(like) == before.end()) {
      map.fail("like", "is '" + like + "', expected the name of a room before");
    }
    r = *find(like);
  }
  r.name = name;
  r.like = like;
  return r;
}

HandHeld readHandHeld(YamlMap& map, const std::string& pattern) {
  HandHeld h;
  h.pattern = pattern;
  h.eye = map.vector3("at_m", h.eye);
  h.target = map.vector3("look_at_m", h.target);
  h.reach_m = map.number("reach_m", h.reach_m, 0.0, 5.0);
  h.swing_rad = map.angle("swing_deg", h.swing_rad);
  h.period_s = map.number("period_s", h.period_s, 0.2, 100.0);
  h.shake = map.number("shake", h.shake, 0.0, 20.0);
  return h;
}

}  // namespace

Vector3d readPlace(YamlMap& map, const std::string& key, double otherwise_z) {
  const auto place = map.placeOf(key);
  if (!place) map.fail(key, "is missing, expected [x, y] or [x, y, z] in metres");
  return {place->x(), place->y(), std::isnan(place->z()) ? otherwise_z : place->z()};
}

RoomSpec readRoom(YamlMap& map, const std::vector<RoomSpec>& before, std::uint32_t seed) {
  RoomSpec r = readLike(map, before, seed);
  r.origin_m = map.vector2("origin_m", r.origin_m);
  r.size_m = map.vector3("size_m", r.size_m);
  if (r.size_m.minCoeff() < 0.5) map.fail("size_m", "is too small, expected 0.5 m or more");
  r.floor = map.word("floor", r.floor, textureKinds());
  r.walls = map.word("walls", r.walls, textureKinds());
  r.ceiling = map.word("ceiling", r.ceiling, textureKinds());
  r.wall_color = map.vector3("wall_color", r.wall_color);
  r.floor_color = map.vector3("floor_color", r.floor_color);
  const Vector2d lamps = map.vector2("lamps", Vector2d(r.lamps_x, r.lamps_y));
  r.lamps_x = static_cast<int>(lamps.x());
  r.lamps_y = static_cast<int>(lamps.y());
  if (lamps.minCoeff() < 0 || lamps.maxCoeff() > 10) map.fail("lamps", "expected 0 to 10 each way");
  r.lamp_radiance = map.number("lamp_radiance", r.lamp_radiance, 0.0, 1000.0);
  if (map.has("furniture")) readFurniture(map.map("furniture"), r.furniture);
  if (map.has("doorways")) r.doorways.clear();
  for (auto& entry : map.maps("doorways")) {
    Doorway d;
    d.wall = entry.word("wall", "south", {"south", "north", "west", "east"});
    d.at_m = entry.number("at_m", 1.0, 0.0, 1000.0);
    d.width_m = entry.number("width_m", d.width_m, 0.3, 10.0);
    d.height_m = entry.number("height_m", d.height_m, 0.5, 10.0);
    entry.finish();
    r.doorways.push_back(d);
  }
  map.finish();
  return r;
}

ObjectSpec readObjectFields(YamlMap& map, std::uint32_t seed) {
  ObjectSpec o;
  o.kind = map.word("kind", "", objectKinds());
  if (map.has("texture")) o.texture = map.word("texture", "", textureKinds());
  o.at_m = readPlace(map, "at_m", 0.0);
  o.yaw_rad = map.angle("yaw_deg", 0.0);
  o.size_m = map.maybeVector3("size_m");
  if (o.size_m && o.size_m->minCoeff() <= 0.0) map.fail("size_m", "expected three sizes above 0");
  o.color = map.maybeVector3("color");
  o.seed =
      map.has("seed") ? static_cast<std::uint32_t>(map.integer("seed", 0, 0, 1000000000)) : seed;
  return o;
}

ObjectSpec readObject(YamlMap& map, std::uint32_t seed) {
  ObjectSpec o = readObjectFields(map, seed);
  map.finish();
  return o;
}

PersonSpec readPerson(YamlMap& map, std::uint32_t seed, const std::vector<ThingSpec>& things) {
  PersonSpec p;
  Dice dice(seed);
  p.name = map.text("name", "");
  p.build.feminine = map.flag("feminine", dice.chance(0.4));
  const double usual = p.build.feminine ? 1.65 : 1.77;
  p.build.height_m = map.number("height_m", usual + dice.between(-0.08, 0.08), 1.2, 2.2);
  p.build.stoutness = map.number("stoutness", dice.between(0.92, 1.14), 0.75, 1.5);
  const int look = map.integer("look", static_cast<int>(dice.next() % 100000U), 0, 1000000000);
  p.outfit = drawOutfit(static_cast<std::uint32_t>(look), p.build.feminine);
  p.start_m = map.vector2("start_m", p.start_m);
  p.yaw_rad = map.angle("yaw_deg", 0.0);
  p.delay_s = map.number("delay_s", 0.0, 0.0, 36000.0);
  p.repeats = map.flag("repeats", true);
  p.stray_m = map.number("stray_m", p.stray_m, 0.0, 10.0);
  for (auto& action : map.maps("script")) p.script.push_back(readAction(action, things));
  settleHands(map, p);
  map.finish();
  return p;
}

void readCamera(YamlMap map, Scenario& scenario) {
  PinholeCamera& c = scenario.camera;
  c.width = map.integer("width", 640, 16, 4096);
  c.height = map.integer("height", c.width * 3 / 4, 16, 4096);
  c.fx = map.number("fx", 525.0 * c.width / 640.0, 1.0, 1e5);
  c.fy = map.number("fy", c.fx, 1.0, 1e5);
  c.cx = map.number("cx", 0.5 * (c.width - 1), 0.0, 1e5);
  c.cy = map.number("cy", 0.5 * (c.height - 1), 0.0, 1e5);
  const std::string motion =
      map.word("motion", "static", {"static", "xyz", "rpy", "halfsphere", "robot"});
  if (motion == "robot") {
    scenario.robot = readRobot(map);
  } else {
    scenario.hand_held = readHandHeld(map, motion);
  }
  map.finish();
}

}  // namespace pf::simulator
