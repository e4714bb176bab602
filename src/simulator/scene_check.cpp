// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/scene_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "posefusion/core/error.hpp"
#include "simulator/walkway.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector2d;

constexpr double kStanding_m = 0.2;  // half the width of a body
constexpr double kWall_m = 0.15;     // things may be let into a wall

std::string textOf(const Vector2d& p) {
  char text[64];
  std::snprintf(text, sizeof text, " is (%.2f, %.2f), ", p.x(), p.y());
  return text;
}

bool isInside(const World& world, const Vector2d& p, double beyond_m) {
  return std::any_of(world.rooms.begin(), world.rooms.end(), [&](const auto& room) {
    const Vector2d low = room.min().template head<2>(), high = room.max().template head<2>();
    return (p - low).minCoeff() >= -beyond_m && (high - p).minCoeff() >= -beyond_m;
  });
}

void expectInside(const std::string& key, const World& world, const Vector2d& p) {
  if (isInside(world, p, 0.0)) return;
  throw InputError(key + textOf(p) + "outside of all rooms");
}

void expectStandable(const std::string& key, const World& world, const Walkway& walkway,
                     const Vector2d& p) {
  if (walkway.isFree(p)) return;
  expectInside(key, world, p);
  throw InputError(key + textOf(p) +
                   "inside a wall or a thing or closer than 20 cm, expected free floor");
}

constexpr double kStep_s = 0.1;
constexpr float kClearance_m = 0.08F;

/// Why a camera cannot be at `p`; empty when it can.
std::string troubleAt(const Eigen::Vector3f& p, const World& world, const RayCaster& caster) {
  bool inside_room = false;
  for (const auto& room : world.rooms) inside_room |= room.contains(p.cast<double>());
  for (const auto& passage : world.passages) {
    const Eigen::Vector2d d = p.head<2>().cast<double>() - passage.centre;
    inside_room |= d.norm() < 0.8;
  }
  if (!inside_room) return "is outside of all rooms";
  int hits = 0, behind = 0;
  for (int i = 0; i < 26; ++i) {
    const int k = i < 13 ? i : i + 1;
    const Eigen::Vector3f d =
        Eigen::Vector3f(static_cast<float>(k % 3 - 1), static_cast<float>(k / 3 % 3 - 1),
                        static_cast<float>(k / 9 - 1))
            .normalized();
    RTCRayHit ray{};
    ray.ray.org_x = p.x(), ray.ray.org_y = p.y(), ray.ray.org_z = p.z();
    ray.ray.dir_x = d.x(), ray.ray.dir_y = d.y(), ray.ray.dir_z = d.z();
    caster.trace(ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
    if (ray.ray.tfar < kClearance_m) return "is closer than 8 cm to a wall or a thing";
    ++hits;
    behind += world.mesh.normals[world.mesh.triangles[ray.hit.primID][0]].dot(d) > 0.0F ? 1 : 0;
  }
  return 2 * behind > hits ? "is inside a wall or a thing" : "";
}

void expectNearRooms(const std::string& key, const World& world, const Eigen::Vector3d& at) {
  const Vector2d p = at.head<2>();
  if (isInside(world, p, kWall_m)) return;
  throw InputError(key + textOf(p) + "outside of all rooms");
}

/// Where a script or a move takes a thing.
void expectPathInside(const std::string& key, const World& world,
                      const std::vector<Eigen::Vector3d>& path) {
  for (const auto& place : path) expectInside(key + "path", world, place.head<2>());
}

void checkThings(const Scenario& scenario, const World& world) {
  for (std::size_t i = 0; i < scenario.things.size(); ++i) {
    const ThingSpec& thing = scenario.things[i];
    const std::string key = entryOf("things", i) + ".";
    expectNearRooms(key + "at_m", world, thing.object.at_m);
    for (std::size_t k = 0; k < thing.moves.size(); ++k) {
      expectPathInside(key + entryOf("moves", k) + ".", world, thing.moves[k].path_m);
    }
  }
}

}  // namespace

void checkScene(const Scenario& scenario, const World& world) {
  for (std::size_t i = 0; i < scenario.objects.size(); ++i) {
    expectNearRooms(entryOf("objects", i) + ".at_m", world, scenario.objects[i].at_m);
  }
  checkThings(scenario, world);
  const Walkway standing(world, kStanding_m), walking(world, kWalkClearance_m);
  for (std::size_t i = 0; i < scenario.people.size(); ++i) {
    const PersonSpec& person = scenario.people[i];
    const std::string entry = entryOf("people", i) + ".";
    const bool seated = !person.script.empty() && person.script.front().kind == Action::Kind::sit;
    if (!seated) expectStandable(entry + "start_m", world, standing, person.start_m);
    for (std::size_t k = 0; k < person.script.size(); ++k) {
      const Action& a = person.script[k];
      const std::string key = entry + entryOf("script", k) + ".";
      const Vector2d at = a.at_m.head<2>();
      if (a.kind == Action::Kind::walk) expectStandable(key + "to", world, standing, at);
      if (a.kind == Action::Kind::sit) expectInside(key + "on", world, at);
      if (a.kind == Action::Kind::put) expectInside(key + "at", world, at);
      expectPathInside(key, world, a.path_m);
      if (a.kind != Action::Kind::walk && a.kind != Action::Kind::sit) continue;
      if (walking.connects(person.start_m, at)) continue;
      throw InputError(key + (a.kind == Action::Kind::sit ? "on" : "to") + textOf(at) +
                       "no way leads there");
    }
  }
}

void checkCamera(const CameraPath& path, const World& world, const RayCaster& caster,
                 double duration_s) {
  for (double t = 0.0; t <= duration_s; t += kStep_s) {
    const Eigen::Vector3f p = path.at(t).translation().cast<float>();
    const std::string trouble = troubleAt(p, world, caster);
    if (trouble.empty()) continue;
    char place[96];
    std::snprintf(place, sizeof place, "camera at (%.2f, %.2f, %.2f) m, %.1f s, ", p.x(), p.y(),
                  p.z(), t);
    throw InputError(place + trouble);
  }
}

}  // namespace pf::simulator
