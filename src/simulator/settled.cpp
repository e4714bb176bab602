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

/// Goals of one person or robot, moved.
class Stray {
 public:
  Stray(const Walkway& walkway, double reach_m, std::uint32_t seed)
      : walkway_(walkway), reach_m_(reach_m), dice_(seed) {}

  Vector2d operator()(const Vector2d& goal) {
    const double angle = dice_.between(0.0, 2.0 * M_PI);
    const double radius = reach_m_ * std::sqrt(dice_.between(0.0, 1.0));
    return walkway_.nearestFree(goal + radius * Vector2d(std::cos(angle), std::sin(angle)));
  }

 private:
  const Walkway& walkway_;
  double reach_m_;
  Dice dice_;
};

void settlePerson(PersonSpec& person, const Walkway& walkway, std::uint32_t seed) {
  if (person.stray_m <= 0.0) return;
  Stray stray(walkway, person.stray_m, seed);
  person.start_m = stray(person.start_m);
  for (Action& action : person.script) {
    if (action.kind == Action::Kind::walk) action.at_m.head<2>() = stray(action.at_m.head<2>());
  }
}

/// The corners of the way from one place to a waypoint, without that place.
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
    const Vector2d moved = stray(goal.at);
    if (!goal.facing_rad) goal.at = moved;
    if (i > 0) {
      if (!walkway.connects(route.back().at, goal.at)) {
        char text[96];
        std::snprintf(text, sizeof text,
                      "camera.waypoints[%zu] is (%.2f, %.2f), no way leads there", i, goal.at.x(),
                      goal.at.y());
        throw InputError(text);
      }
      appendWay(route.back().at, goal, walkway, route);
    }
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
    settlePerson(s.people[i], walkway, hash(s.seed, 64U, static_cast<std::uint32_t>(i)));
  }
  if (s.robot) settleRobot(*s.robot, walkway, hash(s.seed, 65U));
  return s;
}

}  // namespace pf::simulator
