// SPDX-License-Identifier: BSD-3-Clause
// How a frame is put together.
#include <algorithm>
#include <cmath>

#include "simulator/posture.hpp"
#include "simulator/random.hpp"
#include "simulator/settled.hpp"
#include "simulator/simulation_state.hpp"
#include "simulator/truth.hpp"

namespace pf::simulator {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3f;

World buildWorld(const Scenario& s) {
  World world;
  for (const auto& room : s.rooms) addRoom(world, room, hash(s.seed, 61U) % 1000U);
  for (const auto& object : s.objects) addObject(world, object);
  return world;
}

std::vector<Avatar> buildPeople(const Scenario& s) {
  std::vector<Avatar> people;
  people.reserve(s.people.size());
  for (const auto& person : s.people) people.emplace_back(person.build, person.outfit);
  return people;
}

std::vector<ThingShape> buildThings(const Scenario& s, World& world) {
  std::vector<ThingShape> things;
  for (const ThingSpec& thing : s.things) things.push_back(makeThing(world, thing.object));
  return things;
}

std::unique_ptr<CameraPath> buildPath(const Scenario& s) {
  const std::uint32_t seed = hash(s.seed, 62U);
  if (s.robot) return makeRobot(*s.robot, s.start_s + s.duration_s + 1.0, seed);
  return makeHandHeld(s.hand_held.value_or(HandHeld()), seed);
}

}  // namespace

ViewSample viewAt(const Isometry3d& T_world_camera, double time) {
  return {T_world_camera.linear().cast<float>(), T_world_camera.translation().cast<float>(),
          static_cast<float>(std::clamp(time, 0.0, 1.0))};
}

Simulation::State::State(const Scenario& s)
    : world(buildWorld(s)),
      scenario(settled(s, world)),
      people(buildPeople(s)),
      things(buildThings(s, world)),
      caster(world.mesh),
      lighting(world, caster),
      path(buildPath(scenario)),
      crowd(play(thing_tracks)),
      renderer(world, caster),
      color_sensor(s.color),
      exposure(s.color),
      shots{Shot(caster, people, things, s.color), Shot(caster, people, things, s.color)} {}

Simulation::State::Moments Simulation::State::momentsOf(int index, const Exposure& exposed) const {
  const double color = scenario.start_s + (index + 1) / scenario.fps;
  const float luck = gaussian(hash(scenario.seed, 71U, static_cast<std::uint32_t>(index)));
  const double jitter = std::clamp<double>(luck, -3.0, 3.0) * scenario.depth.jitter_ms;
  const double depth = color + 1e-3 * (scenario.depth.offset_ms + jitter);
  const double exposed_s = scenario.color.motion_blur ? 1e-3 * exposed.time_ms : 0.0;
  const double half = 0.5 * (exposed_s + 1e-3 * scenario.color.rolling_shutter_ms) + 1e-4;
  return {index, exposed, color, depth, color - half, color + half};
}

bool Simulation::State::isDropped(int index) const {
  return uniform(hash(scenario.seed, 73U, static_cast<std::uint32_t>(index))) < scenario.dropped;
}

double Simulation::State::smearOf(const Moments& m) const {
  const double half = 0.5e-3 * m.exposure.time_ms;
  const Isometry3d T = path->at(m.color - half).inverse() * path->at(m.color + half);
  const PinholeCamera& c = scenario.camera;
  double most = 0.0;
  for (const double u : {0.0, 0.5, 1.0}) {
    for (const double v : {0.0, 0.5, 1.0}) {
      const Eigen::Vector2d pixel(u * (c.width - 1), v * (c.height - 1));
      const Eigen::Vector3d p = T * c.unproject(pixel.x(), pixel.y(), 2.0);
      if (p.z() > 0.1) most = std::max(most, (c.project(p) - pixel).norm());
    }
  }
  return most;
}

double Simulation::State::limbSmearOf(const Moments& m) const {
  // Hands of a walker are about twice as fast as the walker.
  const Eigen::Vector3d eye = path->at(m.color).translation();
  double most = 0.0;
  for (std::size_t i = 0; i < people.size(); ++i) {
    const ActorState state = crowd.at(i, m.color);
    const double distance = std::max(0.5, (state.at - eye.head<2>()).norm());
    const double speed = 2.0 * state.speed_m_s + 0.6 * state.talk + 0.5 * state.reach;
    most = std::max(most, speed * 1e-3 * m.exposure.time_ms / distance * scenario.camera.fx);
  }
  for (const ThingTrack& track : thing_tracks) {
    const double distance = std::max(0.5, (track.at(m.color).at_m - eye).norm());
    const double moved = track.speed(m.color) * 1e-3 * m.exposure.time_ms;
    most = std::max(most, moved / distance * scenario.camera.fx);
  }
  return most;
}

int Simulation::State::samplesFor(double smear_px) const {
  const ColorConfig& c = scenario.color;
  if (!c.motion_blur) return 1;
  const int wanted = static_cast<int>(std::ceil(smear_px / 3.0));
  return std::clamp(wanted, c.samples, std::max(c.samples, c.max_samples));
}

Simulation::State::Shot& Simulation::State::take(int index) {
  if (preparing.valid()) preparing.get();
  if (shots[1 - current].moments.index == index) {
    current = 1 - current;
  } else {
    prepare(shots[current], momentsOf(index, exposure.current()));
  }
  return shots[current];
}

void Simulation::State::prepareInBackground(int index) {
  preparing = std::async(std::launch::async,
                         [this, &shot = shots[1 - current],
                          m = momentsOf(index, exposure.current())] { prepare(shot, m); });
}

void Simulation::State::forgetPrepared() {
  if (preparing.valid()) preparing.get();
  for (Shot& shot : shots) shot.moments.index = -1;
}

Postures Simulation::State::posturesAt(double time) const {
  Postures postures;
  for (std::size_t i = 0; i < people.size(); ++i) {
    const std::uint32_t seed = hash(scenario.seed, 72U, static_cast<std::uint32_t>(i));
    postures.push_back(poseBody(people[i].rig(), crowd.at(i, time), seed));
  }
  return postures;
}

void Simulation::State::prepare(Shot& shot, const Moments& m) const {
  shot.moments.index = -1;  // until it is whole
  const MoverPoses middle = posesAt(m.color);
  if (shot.in_color.moves()) {
    shot.in_color.pose({posesAt(m.first), posesAt(m.last)});
  } else {
    shot.in_color.pose({middle});
  }
  shot.in_depth.pose({posesAt(m.depth)});
  placeSurfaces(m, middle, shot.surfaces);
  lighting.illuminate(shot.surfaces, shot.in_color, viewConeOf(m), shot.light);
  shot.moments = m;
}

ViewCone Simulation::State::viewConeOf(const Moments& m) const {
  const PinholeCamera& c = scenario.camera;
  const Isometry3d T = path->at(m.color);
  const double x = std::max(c.cx, c.width - c.cx) / c.fx,
               y = std::max(c.cy, c.height - c.cy) / c.fy;
  double angle = std::atan(std::hypot(x, y));
  for (const double time : {m.first, m.last}) {
    angle += Eigen::AngleAxisd(T.linear().transpose() * path->at(time).linear()).angle();
  }
  return {T.translation().cast<float>(), T.linear().col(2).cast<float>(),
          static_cast<float>(angle)};
}

Shutter Simulation::State::shutterFor(const Moments& m, int samples) const {
  Shutter shutter;
  shutter.samples = samples;
  const double rolling = 1e-3 * scenario.color.rolling_shutter_ms;
  shutter.bands = rolling > 0.0 ? (scenario.camera.height + 7) / 8 : 1;
  const int moments = samples * kViewsPerSample;
  for (int band = 0; band < shutter.bands; ++band) {
    const double row = shutter.bands > 1 ? (band + 0.5) / shutter.bands - 0.5 : 0.0;
    for (int i = 0; i < moments; ++i) {
      const double part = scenario.color.motion_blur ? (i + 0.5) / moments - 0.5 : 0.0;
      const double time = m.color + 1e-3 * m.exposure.time_ms * part + rolling * row;
      shutter.views.push_back(viewAt(path->at(time), m.within(time)));
    }
  }
  return shutter;
}

void Simulation::State::draw(const Shot& shot, SimulatedFrame& out) {
  const Moments& m = shot.moments;
  const auto number = static_cast<std::uint32_t>(m.index);
  out.T_world_camera = path->at(m.color);
  out.exposure = m.exposure;
  out.smear_px = scenario.color.motion_blur ? smearOf(m) : 0.0;
  out.frame.camera = scenario.camera;
  const Shutter still = shutterFor(m, samplesFor(out.smear_px));
  const Shutter moving = shutterFor(m, samplesFor(out.smear_px + limbSmearOf(m)));
  renderer.color(scenario.camera, still, moving, {shot.in_color, shot.light}, radiance);
  const bool first = !exposure.isSet();
  exposure.look(radiance);
  if (first) out.exposure = exposure.current();
  color_sensor.expose(radiance, out.exposure, hash(scenario.seed, 74U, number), out.frame.color);
  const ViewSample depth_view = viewAt(path->at(m.depth), 0.0);
  renderer.depth(scenario.camera, depth_view, shot.in_depth, view);
  senseDepth({view, scenario.camera, scenario.depth, hash(scenario.seed, 75U, number), m.depth},
             out.frame.depth, label);
  labelMovers(m, label, out);
  observePeople(m, out);
}

void Simulation::State::observePeople(const Moments& m, SimulatedFrame& out) const {
  const Postures postures = posturesAt(m.color);
  for (std::size_t i = 0; i < people.size(); ++i) {
    PersonTruth truth = observe(static_cast<int>(i), jointsOf(people[i].rig(), postures[i]),
                                scenario.camera, out.T_world_camera, view);
    truth.name = scenario.people[i].name;
    const bool near =
        std::any_of(truth.in_view.begin(), truth.in_view.end(), [](bool b) { return b; });
    if (truth.pixels > 0 || near) out.people.push_back(truth);
  }
}

}  // namespace pf::simulator
