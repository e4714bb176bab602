// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/settled.hpp"

#include <cmath>
#include <cstdio>

#include "posefusion/core/error.hpp"
#include "simulator/random.hpp"
#include "simulator/walkway.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector2d;

constexpr double kNear_m = 1.0;  // that a goal is moved at most to free floor

/// Goals of one person or robot, moved.
class Stray {
 public:
  Stray(const Walkway& walkway, double reach_m, std::uint32_t seed)
      : walkway_(walkway), reach_m_(reach_m), dice_(seed) {}

  /// One that is `exact` goes only as far as it has to. Throws InputError naming `key` where
  /// nothing free is near.
  Vector2d operator()(const Vector2d& goal, const std::string& key, bool exact = false) {
    const double angle = dice_.between(0.0, 2.0 * M_PI);
    const double part = std::sqrt(dice_.between(0.0, 1.0));
    const double radius = exact ? 0.0 : reach_m_ * part;
    const Vector2d wanted = goal + radius * Vector2d(std::cos(angle), std::sin(angle));
    const Vector2d place = walkway_.nearestFree(wanted);
    if ((place - wanted).norm() <= kNear_m) return place;
    char text[64];
    std::snprintf(text, sizeof text, " is (%.2f, %.2f), no way leads there", goal.x(), goal.y());
    throw InputError(key + text);
  }

 private:
  const Walkway& walkway_;
  double reach_m_;
  Dice dice_;
};

void settlePerson(PersonSpec& person, const std::string& key, Stray stray) {
  if (person.stray_m <= 0.0) return;
  person.start_m = stray(person.start_m, key + ".start_m");
  for (std::size_t i = 0; i < person.script.size(); ++i) {
    Action& action = person.script[i];
    if (action.kind != Action::Kind::walk) continue;
    action.at_m.head<2>() = stray(action.at_m.head<2>(), key + "." + entryOf("script", i) + ".to");
  }
}

/// The corners of the way from one place to a waypoint, without both ends.
void appendWay(const Vector2d& from, const Waypoint& to, const Walkway& walkway,
               std::vector<Waypoint>& route) {
  const auto way = walkway.findWay(from, to.at);
  for (std::size_t i = 1; i + 1 < way.size(); ++i) route.push_back({way[i], to.facing_rad});
}

void settleRobot(Robot& robot, const Walkway& walkway, std::uint32_t seed) {
  if (!robot.finds_way) return;
  Stray stray(walkway, robot.stray_m, seed);
  std::vector<Waypoint> route;
  for (std::size_t i = 0; i < robot.waypoints.size(); ++i) {
    Waypoint goal = robot.waypoints[i];
    goal.at = stray(goal.at, "camera." + entryOf("waypoints", i), goal.facing_rad.has_value());
    if (i > 0) appendWay(route.back().at, goal, walkway, route);
    route.push_back(goal);
  }
  if (robot.repeats) appendWay(route.back().at, route.front(), walkway, route);
  robot.waypoints = std::move(route);
}

}  // namespace

Scenario settled(Scenario s, const World& world) {
  Walkway walkway(world, kWalkClearance_m);
  if (s.robot && s.robot->finds_way) walkway.keepReachable(s.robot->waypoints.front().at);
  for (std::size_t i = 0; i < s.people.size(); ++i) {
    const std::uint32_t seed = hash(s.seed, 64U, static_cast<std::uint32_t>(i));
    settlePerson(s.people[i], entryOf("people", i), {walkway, s.people[i].stray_m, seed});
  }
  if (s.robot) settleRobot(*s.robot, walkway, hash(s.seed, 65U));
  return s;
}

}  // namespace pf::simulator
