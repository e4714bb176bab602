// SPDX-License-Identifier: BSD-3-Clause
// What a simulation does with things that may move.
#include <algorithm>
#include <cmath>

#include "simulator/simulation_state.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kNearest_m = 0.8, kFarthest_m = 4.5;  // at which a thing is said to be seen

}  // namespace

ThingWatch Simulation::State::watch() const {
  ThingWatch watch;
  watch.may_see = [this](const Vector3d& centre, double radius_m, double time_s) {
    const Eigen::Isometry3d T = path->at(time_s);
    const PinholeCamera& c = scenario.camera;
    const double half_angle = std::atan(std::hypot(c.width / c.fx, c.height / c.fy) / 2.0);
    const Vector3d d = centre - T.translation();
    const double distance = d.norm();
    if (distance <= radius_m) return true;
    const double angle = std::acos(std::clamp(T.linear().col(2).dot(d) / distance, -1.0, 1.0));
    return angle <= half_angle + std::asin(radius_m / distance);
  };
  watch.sees = [this](const Vector3d& centre, double radius_m, double time_s) {
    const Eigen::Isometry3d T = path->at(time_s);
    const Vector3d p = T.inverse() * centre;
    if (p.z() < kNearest_m || p.z() > kFarthest_m) return false;
    const Eigen::Vector2d uv = scenario.camera.project(p);
    if (uv.minCoeff() < 0.0 || uv.x() > scenario.camera.width || uv.y() > scenario.camera.height) {
      return false;
    }
    SightPacket sight;
    sight.from[0] = T.translation().cast<float>();
    sight.to[0] = centre.cast<float>();
    sight.asked[0] = true;
    // The thing is not in the still world: what is within its reach is what it stands on.
    return !caster.blocks(sight, std::min(static_cast<float>(radius_m), 0.4F))[0];
  };
  return watch;
}

Crowd Simulation::State::play(std::vector<ThingTrack>& tracks) const {
  ThingStage stage(scenario.things, things, watch());
  const auto lens = [this](double t) -> Eigen::Vector2d {
    return path->at(t).translation().head<2>();
  };
  Crowd played(scenario.people, Walkway(world, kWalkClearance_m), lens,
               scenario.start_s + scenario.duration_s + 1.0, &stage);
  tracks = stage.tracks();
  for (ThingTrack& track : tracks) {
    if (!scenario.things_move) track.freeze();
  }
  return played;
}

MoverPoses Simulation::State::posesAt(double time) const {
  MoverPoses poses{posturesAt(time)};
  for (const ThingTrack& track : thing_tracks) poses.things.push_back(track.at(time));
  return poses;
}

void Simulation::State::placeSurfaces(const Moments& m, const MoverPoses& poses,
                                      MoverSurfaces& surfaces) const {
  surfaces.people.resize(people.size());
  surfaces.things.resize(things.size());
  surfaces.places.clear();
  for (std::size_t i = 0; i < people.size(); ++i) {
    MoverSurfaces::Body& body = surfaces.people[i];
    body.positions.resize(people[i].vertexCount());
    people[i].skin(poses.people[i], body.positions[0].data());
    people[i].skinNormals(poses.people[i], body.normals);
    surfaces.places.push_back(crowd.at(i, m.color).at.cast<float>());
  }
  for (std::size_t i = 0; i < things.size(); ++i) {
    const Eigen::Isometry3f T = poses.things[i].matrix().cast<float>();
    MoverSurfaces::Body& body = surfaces.things[i];
    body.positions.clear();
    body.normals.clear();
    for (const Vector3f& p : things[i].mesh.positions) body.positions.push_back(T * p);
    for (const Vector3f& n : things[i].mesh.normals) body.normals.push_back(T.linear() * n);
    const Vector3f middle = T * Vector3f(things[i].box.center().cast<float>());
    surfaces.places.emplace_back(middle.head<2>());
  }
}

void Simulation::State::labelMovers(const Moments& m, const cv::Mat& labels,
                                    SimulatedFrame& out) const {
  labels.copyTo(out.mask);
  if (things.empty()) return;
  out.thing_mask = cv::Mat::zeros(labels.size(), CV_8UC1);
  std::vector<std::uint8_t> number(256, 0);  // of a label
  for (std::size_t i = 0; i < things.size(); ++i) {
    if (thing_tracks[i].isMoving(m.depth)) {
      number[kFirstThing + i] = static_cast<std::uint8_t>(i + 1);
    }
  }
  for (int row = 0; row < labels.rows; ++row) {
    for (int col = 0; col < labels.cols; ++col) {
      const std::uint8_t value = labels.at<std::uint8_t>(row, col);
      if (value < kFirstThing) continue;
      out.mask.at<std::uint8_t>(row, col) = 0;
      out.thing_mask.at<std::uint8_t>(row, col) = number[value];
    }
  }
}

}  // namespace pf::simulator
