// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/thing_check.hpp"

#include <utility>

namespace pf {
namespace {

constexpr float kThingRadius_m = 0.015F;
constexpr std::int64_t kStep_ns = 100'000'000;  // between two poses on the way

using Points = std::vector<Eigen::Vector3f>;

Eigen::AlignedBox3f boxOf(const SurfaceSamples& surface) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : surface.positions) box.extend(p);
  if (box.isEmpty()) return box;
  const Eigen::Vector3f beyond = Eigen::Vector3f::Constant(kOnThing_m);
  return {box.min() - beyond, box.max() + beyond};
}

/// Takes the points out that lie on the thing at one of the poses; returns how many.
std::size_t takeOut(const SurfaceSamples& surface, const std::vector<Eigen::Isometry3d>& poses,
                    Points& points) {
  const Eigen::AlignedBox3f box = boxOf(surface);
  const std::size_t before = points.size();
  for (const Eigen::Isometry3d& pose : poses) {
    const Eigen::Isometry3f T_thing_world = pose.inverse().cast<float>();
    Points near, rest;
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3f p = T_thing_world * points[i];
      if (!box.contains(p)) continue;
      near.push_back(p);
      which.push_back(i);
    }
    if (near.empty()) continue;
    const std::vector<float> distances = distancesToSurface(near, surface);
    std::vector<char> is_on(points.size(), 0);
    for (std::size_t k = 0; k < near.size(); ++k) is_on[which[k]] = distances[k] <= kOnThing_m;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (is_on[i] == 0) rest.push_back(points[i]);
    }
    points = std::move(rest);
  }
  return before - points.size();
}

std::vector<Eigen::Isometry3d> oldPlaces(const RecordedThing& thing) {
  std::vector<Eigen::Isometry3d> poses;
  for (const ThingMove& move : thing.moves) poses.push_back(move.from);
  return poses;
}

std::vector<Eigen::Isometry3d> wayOf(const RecordedThing& thing) {
  std::vector<Eigen::Isometry3d> poses;
  for (const ThingMove& move : thing.moves) {
    for (std::int64_t t = move.begin_ns; t < move.end_ns; t += kStep_ns) {
      if (const auto pose = poseAt(thing.poses, t)) poses.push_back(*pose);
    }
  }
  return poses;
}

}  // namespace

SurfaceSamples surfaceOf(const RecordedThing& thing) {
  SurfaceSamples surface;
  surface.radius_m = kThingRadius_m;
  for (const SurfacePoint& point : thing.points) {
    surface.positions.push_back(point.position);
    surface.normals.push_back(point.normal);
  }
  return surface;
}

std::size_t RemainsScore::remains() const {
  std::size_t sum = 0;
  for (const ThingRemains& thing : things) sum += thing.at_old_places + thing.on_the_way;
  return sum;
}

double RemainsScore::share() const {
  return surfels > 0 ? static_cast<double>(remains()) / static_cast<double>(surfels) : 0.0;
}

RemainsScore checkRemains(const Points& surfels, const SurfaceSamples& scene,
                          const std::vector<RecordedThing>& things) {
  RemainsScore score;
  score.surfels = surfels.size();
  const std::vector<float> distances = distancesToSurface(surfels, scene);
  Points unexplained;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    if (distances[i] > kOnThing_m) unexplained.push_back(surfels[i]);
  }
  for (const RecordedThing& thing : things) {
    const SurfaceSamples surface = surfaceOf(thing);
    ThingRemains remains{thing.name, 0, 0};
    remains.at_old_places = takeOut(surface, oldPlaces(thing), unexplained);
    remains.on_the_way = takeOut(surface, wayOf(thing), unexplained);
    score.things.push_back(remains);
  }
  return score;
}

}  // namespace pf
