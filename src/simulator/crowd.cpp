// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/crowd.hpp"

#include <algorithm>
#include <cmath>

#include "simulator/actor.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector2d;

constexpr double kPersonRadius_m = 0.32;
constexpr double kCameraRadius_m = 0.55;

double turned(double from, double to, double t) {
  return from + t * std::remainder(to - from, 2.0 * M_PI);
}

/// Moves a walker out of another's circle.
void pushOut(Actor& actor, const Vector2d& from, double reach_m) {
  const Vector2d d = actor.state().at - from;
  const double distance = d.norm();
  if (distance >= reach_m || distance < 1e-6) return;
  actor.push(d / distance * (reach_m - distance));
}

}  // namespace

ActorState interpolate(const ActorState& a, const ActorState& b, double t) {
  const auto mix = [t](double x, double y) { return x + (y - x) * t; };
  ActorState s = a;
  s.at = a.at + t * (b.at - a.at);
  s.yaw = turned(a.yaw, b.yaw, t);
  s.speed_m_s = mix(a.speed_m_s, b.speed_m_s);
  s.pelvis_m = mix(a.pelvis_m, b.pelvis_m);
  for (std::size_t i = 0; i < 2; ++i) {
    s.feet[i].at = a.feet[i].at + t * (b.feet[i].at - a.feet[i].at);
    s.feet[i].lift_m = mix(a.feet[i].lift_m, b.feet[i].lift_m);
    s.feet[i].yaw = turned(a.feet[i].yaw, b.feet[i].yaw, t);
    s.feet[i].pitch = mix(a.feet[i].pitch, b.feet[i].pitch);
  }
  s.sit = mix(a.sit, b.sit);
  s.crouch = mix(a.crouch, b.crouch);
  s.talk = mix(a.talk, b.talk);
  s.reach = mix(a.reach, b.reach);
  s.carry = mix(a.carry, b.carry);
  s.reach_at = a.reach_at + t * (b.reach_at - a.reach_at);
  s.grasp = mix(a.grasp, b.grasp);
  for (std::size_t i = 0; i < 2; ++i) {
    s.grasp_at[i] = a.grasp_at[i] + t * (b.grasp_at[i] - a.grasp_at[i]);
  }
  s.time_s = mix(a.time_s, b.time_s);
  return s;
}

Crowd::Crowd(const std::vector<PersonSpec>& people, const Walkway& walkway,
             const std::function<Vector2d(double)>& camera, double duration_s, ThingStage* things) {
  std::vector<Actor> actors;
  for (std::size_t i = 0; i < people.size(); ++i)
    actors.emplace_back(people[i], walkway, things, i);
  tracks_.resize(people.size());
  const int steps = static_cast<int>(std::ceil(duration_s / kActorStep_s)) + 2;
  for (int step = 0; step < steps; ++step) {
    const Vector2d lens = camera(step * kActorStep_s);
    if (things != nullptr) things->advance(step * kActorStep_s);
    std::vector<Vector2d> places;
    for (const auto& actor : actors) places.push_back(actor.bodyPlace());
    for (std::size_t i = 0; i < actors.size(); ++i) {
      std::vector<Vector2d> others{lens};
      for (std::size_t j = 0; j < actors.size(); ++j) {
        if (j != i) others.push_back(places[j]);
      }
      actors[i].step(others);
      for (const auto& other : others) {
        pushOut(actors[i], other, &other == &others[0] ? kCameraRadius_m : 2 * kPersonRadius_m);
      }
      actors[i].carry();
      tracks_[i].push_back(actors[i].state());
    }
    if (things != nullptr) things->record();
  }
}

ActorState Crowd::at(std::size_t person, double time_s) const {
  const auto& track = tracks_[person];
  const double x = std::clamp(time_s / kActorStep_s, 0.0, static_cast<double>(track.size() - 2));
  const auto i = static_cast<std::size_t>(x);
  return interpolate(track[i], track[i + 1], x - static_cast<double>(i));
}

}  // namespace pf::simulator
