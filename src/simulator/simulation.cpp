// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/simulation.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "simulator/random.hpp"
#include "simulator/scene_check.hpp"
#include "simulator/simulation_state.hpp"

namespace pf::simulator {
namespace {

constexpr std::int64_t kFirstStamp_ns = 1000000000000;  // 1000 s: a bag cannot begin at zero
constexpr double kVisitStep_s = 0.05;
constexpr double kAfter_s = 0.05;  // of truth after the last frame: its depth is taken later

}  // namespace

Simulation::Simulation(const Scenario& scenario) try : state_(std::make_unique<State>(scenario)) {
  checkScene(state_->scenario, state_->world);
  checkCamera(*state_->path, state_->world, state_->caster, scenario.start_s + scenario.duration_s);
} catch (const InputError& error) {
  throw InputError(scenario.name + ": " + error.what());
}

Simulation::~Simulation() = default;

int Simulation::frameCount() const {
  return std::max(
      1, static_cast<int>(std::floor(state_->scenario.duration_s * state_->scenario.fps + 1e-6)));
}

SimulatedFrame Simulation::frame(int index) {
  State& s = *state_;
  SimulatedFrame out;
  out.index = index;
  out.dropped = s.isDropped(index);
  if (out.dropped) {
    const State::Moments m = s.momentsOf(index, s.exposure.current());
    out.frame.stamp_ns = stampOf(m.color);
    out.depth_stamp_ns = stampOf(m.depth);
    return out;
  }
  State::Shot& shot = s.take(index);
  int next = index + 1;
  while (next < frameCount() && s.isDropped(next)) ++next;
  if (s.exposure.isSet() && next < frameCount()) s.prepareInBackground(next);
  s.draw(shot, out);
  out.frame.stamp_ns = stampOf(shot.moments.color);
  out.depth_stamp_ns = stampOf(shot.moments.depth);
  return out;
}

void Simulation::jump() {
  state_->forgetPrepared();
  state_->exposure.restart();
}

TimeSpan Simulation::spanOf(int frames) const {
  const Scenario& s = state_->scenario;
  return {s.start_s, s.start_s + frames / s.fps + kAfter_s};
}

Senses Simulation::senses(int frames) const {
  const Scenario& s = state_->scenario;
  const TimeSpan span = spanOf(frames);
  return {senseImu(*state_->path, s.imu, span, hash(s.seed, 81U)),
          senseLegs(*state_->path, s.legs, span, hash(s.seed, 82U))};
}

Trajectory Simulation::truth(int frames) const {
  const State& s = *state_;
  const TruthConfig& c = s.scenario.truth;
  Trajectory trajectory;
  const int count =
      static_cast<int>(std::floor((frames / s.scenario.fps + kAfter_s) * c.rate_hz)) + 1;
  for (int i = 0; i < count; ++i) {
    const double t = s.scenario.start_s + i / c.rate_hz;
    if (c.gap_every_s > 0.0) {
      const auto window = static_cast<std::uint32_t>(t / c.gap_every_s);
      const double gap = window * c.gap_every_s + between(hash(s.scenario.seed, 76U, window), 0.0,
                                                          std::max(0.0, c.gap_every_s - c.gap_s));
      if (t >= gap && t < gap + c.gap_s) continue;
    }
    Vector6d error;
    for (int k = 0; k < 6; ++k) {
      const float luck = gaussian(
          hash(s.scenario.seed, 77U, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(k)));
      error[k] = luck * (k < 3 ? c.noise_m : c.noise_rad);
    }
    trajectory.push_back({stampOf(t), s.path->at(t) * expSe3(error)});
  }
  return trajectory;
}

std::vector<Event> Simulation::events(int frames) const {
  const auto [from, to] = spanOf(frames);
  std::vector<Event> events;
  for (const Event& e : state_->path->events()) {
    if (e.end_s <= from || e.start_s >= to) continue;
    events.push_back({e.kind, std::max(e.start_s, from), std::min(e.end_s, to)});
  }
  return events;
}

std::vector<Visit> Simulation::visits(int frames) const {
  const Scenario& scenario = state_->scenario;
  const auto [from, to] = spanOf(frames);
  std::vector<Visit> visits;
  for (double t = from; t < to; t += kVisitStep_s) {
    const Eigen::Vector2d at = state_->path->at(t).translation().head<2>();
    const auto room = std::find_if(scenario.rooms.begin(), scenario.rooms.end(), [&](auto& r) {
      const Eigen::Array2d inside = at - r.origin_m;
      return (inside >= 0.0).all() && (inside <= r.size_m.template head<2>().array()).all();
    });
    if (room == scenario.rooms.end()) continue;
    const bool moves_on = visits.empty() || visits.back().room != room->name;
    if (moves_on && !visits.empty()) visits.back().end_s = t;
    if (moves_on) visits.push_back({room->name, t, to});
  }
  visits.erase(std::remove_if(visits.begin(), visits.end(),
                              [](const Visit& visit) { return visit.room.empty(); }),
               visits.end());
  return visits;
}

std::int64_t Simulation::stampOf(double time_s) const {
  return kFirstStamp_ns + static_cast<std::int64_t>(std::llround(time_s * 1e6)) * 1000;
}

std::vector<std::vector<ThingChange>> Simulation::thingChanges(int frames) const {
  const auto [from, to] = spanOf(frames);
  std::vector<std::vector<ThingChange>> changes;
  for (const ThingTrack& track : state_->thing_tracks) changes.push_back(track.changes(from, to));
  return changes;
}

Trajectory Simulation::thingPoses(std::size_t thing, int frames) const {
  const auto [from, to] = spanOf(frames);
  const ThingTrack& track = state_->thing_tracks[thing];
  Trajectory poses;
  for (const double t : track.knots(from, to)) poses.push_back({stampOf(t), track.at(t).matrix()});
  return poses;
}

Mesh Simulation::sceneAfter(int frames) const {
  const State& s = *state_;
  const double last_s = s.momentsOf(std::max(0, frames - 1), {}).depth;
  Mesh scene = s.world.mesh;
  for (std::size_t i = 0; i < s.things.size(); ++i) {
    append(s.things[i].mesh, s.thing_tracks[i].at(last_s), scene);
  }
  return scene;
}

const std::vector<ThingShape>& Simulation::things() const { return state_->things; }
const World& Simulation::world() const { return state_->world; }
const Scenario& Simulation::scenario() const { return state_->scenario; }

}  // namespace pf::simulator
