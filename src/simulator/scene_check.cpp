// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/scene_check.hpp"

#include <algorithm>
#include <cstdio>

#include "posefusion/core/error.hpp"
#include "simulator/walkway.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector2d;

constexpr double kStandingM = 0.2;  // half the width of a body
constexpr double kWallM = 0.15;     // things may be let into a wall

std::string entryOf(const char* list, std::size_t index) {
  return std::string(list) + "[" + std::to_string(index) + "]";
}

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

}  // namespace

void checkScene(const Scenario& scenario, const World& world) {
  for (std::size_t i = 0; i < scenario.objects.size(); ++i) {
    const Vector2d at = scenario.objects[i].at_m.head<2>();
    if (isInside(world, at, kWallM)) continue;
    throw InputError(entryOf("objects", i) + ": at_m" + textOf(at) + "outside of all rooms");
  }
  const Walkway standing(world, kStandingM), walking(world, kWalkClearanceM);
  for (std::size_t i = 0; i < scenario.people.size(); ++i) {
    const PersonSpec& person = scenario.people[i];
    const std::string who = entryOf("people", i) + ": ";
    const bool seated = !person.script.empty() && person.script.front().kind == Action::Kind::sit;
    if (!seated) expectStandable(who + "start_m", world, standing, person.start_m);
    for (std::size_t k = 0; k < person.script.size(); ++k) {
      const Action& a = person.script[k];
      const std::string key = who + entryOf("script", k) + ": ";
      const Vector2d at = a.at_m.head<2>();
      if (a.kind == Action::Kind::walk) expectStandable(key + "to", world, standing, at);
      if (a.kind == Action::Kind::sit) expectInside(key + "on", world, at);
      if (a.kind != Action::Kind::walk && a.kind != Action::Kind::sit) continue;
      if (walking.connects(person.start_m, at)) continue;
      throw InputError(key + (a.kind == Action::Kind::sit ? "on" : "to") + textOf(at) +
                       "no way leads there");
    }
  }
}

}  // namespace pf::simulator
