// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/thing_stage.hpp"
#include "simulator/easing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pf::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kOnFloor_m = 0.4;  // things that stand lower are in the way of people
constexpr int kGlances = 4;         // at which it must be out of view while it moves unseen

/// The place after the part `t` of a way's length.
Vector3d along(const std::vector<Vector3d>& way, double t) {
  double length = 0.0;
  for (std::size_t i = 1; i < way.size(); ++i) length += (way[i] - way[i - 1]).norm();
  double left = t * length;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const double leg = (way[i] - way[i - 1]).norm();
    if (left <= leg && leg > 0.0) return way[i - 1] + left / leg * (way[i] - way[i - 1]);
    left -= leg;
  }
  return way.back();
}

}  // namespace

std::vector<Vector3d> rounded(std::vector<Vector3d> way) {
  for (int pass = 0; pass < 2 && way.size() > 2; ++pass) {
    std::vector<Vector3d> cut{way.front()};
    for (std::size_t i = 1; i < way.size(); ++i) {
      const Vector3d step = way[i] - way[i - 1];
      if (i > 1) cut.push_back(way[i - 1] + 0.25 * step);
      if (i + 1 < way.size()) cut.push_back(way[i - 1] + 0.75 * step);
    }
    cut.push_back(way.back());
    way = std::move(cut);
  }
  return way;
}

ThingStage::ThingStage(const std::vector<ThingSpec>& specs, const std::vector<ThingShape>& shapes,
                       ThingWatch watch)
    : specs_(specs), watch_(std::move(watch)), now_(specs.size()), tracks_(specs.size()) {
  for (std::size_t i = 0; i < specs.size(); ++i) {
    boxes_.push_back(shapes[i].box);
    now_[i].pose = {specs[i].object.at_m, specs[i].object.yaw_rad};
  }
}

double ThingStage::halfExtent(std::size_t thing, double yaw_rad) const {
  const double angle = yaw_rad - pose(thing).yaw_rad;
  const Vector2d half = 0.5 * boxes_[thing].sizes().head<2>();
  return std::abs(std::cos(angle)) * half.x() + std::abs(std::sin(angle)) * half.y();
}

bool ThingStage::isBusy(std::size_t thing) const {
  return now_[thing].mover != ThingTrack::kAtRest;
}

void ThingStage::take(std::size_t thing, std::size_t person) {
  now_[thing].mover = static_cast<int>(person);
}

void ThingStage::leave(std::size_t thing) { now_[thing].mover = ThingTrack::kAtRest; }

std::vector<Vector2d> ThingStage::standingNear(const Vector2d& place, double reach_m) const {
  std::vector<Vector2d> places;
  for (std::size_t i = 0; i < size(); ++i) {
    const Vector3d middle = pose(i).matrix() * boxes_[i].center();
    if (pose(i).at_m.z() >= kOnFloor_m || isBusy(i)) continue;
    if ((middle.head<2>() - place).norm() < reach_m) places.emplace_back(middle.head<2>());
  }
  return places;
}

ThingPose ThingStage::poseOn(const Now& now, const ThingMove& move, std::size_t thing,
                             double t) const {
  const double part = smooth(std::clamp(t, 0.0, 1.0));
  ThingPose pose = now.from;
  pose.yaw_rad += part * move.turn_rad;
  if (!now.way.empty()) {
    pose.at_m = along(now.way, part);
    return pose;
  }
  const Vector3d hinge(specs_[thing].hinge_m.x(), specs_[thing].hinge_m.y(), 0.0);
  pose.at_m += now.from.matrix().linear() * hinge - pose.matrix().linear() * hinge;
  return pose;
}

void ThingStage::prepare(const ThingMove& move, Now& now) const {
  now.from = now.pose;
  now.way.clear();
  if (move.path_m.empty()) return;
  now.way.push_back(now.pose.at_m);
  for (Vector3d place : move.path_m) {
    if (std::isnan(place.z())) place.z() = now.pose.at_m.z();
    now.way.push_back(place);
  }
  now.way = rounded(now.way);
}

bool ThingStage::mayBegin(const ThingMove& move, std::size_t thing, double time_s) const {
  if (time_s < move.at_s || isBusy(thing)) return false;
  if (move.when == ThingMove::When::time) return true;
  const double radius = 0.5 * boxes_[thing].sizes().norm();
  const Vector3d centre = boxes_[thing].center();
  Now trial = now_[thing];
  prepare(move, trial);
  if (move.when == ThingMove::When::seen) {
    return watch_.sees(trial.pose.matrix() * centre, radius, time_s);
  }
  // Neither where it is, nor on its way, nor where it goes, from before it moves until after.
  for (int i = -1; i <= kGlances + 1; ++i) {
    const double t = static_cast<double>(i) / kGlances;
    for (const double place : {0.0, 0.5, 1.0}) {
      const Vector3d at = poseOn(trial, move, thing, place).matrix() * centre;
      if (watch_.may_see(at, radius, time_s + t * move.over_s)) return false;
    }
  }
  return true;
}

void ThingStage::advance(double time_s) {
  for (std::size_t i = 0; i < size(); ++i) {
    Now& now = now_[i];
    if (now.next >= specs_[i].moves.size()) continue;
    const ThingMove& move = specs_[i].moves[now.next];
    if (now.begun_s < 0.0 && mayBegin(move, i, time_s)) {
      prepare(move, now);
      now.begun_s = time_s;
      now.mover = ThingTrack::kItself;
    }
    if (now.begun_s < 0.0) continue;
    const double t = (time_s - now.begun_s) / move.over_s;
    now.pose = poseOn(now, move, i, t);
    if (t < 1.0) continue;
    now.begun_s = -1.0;
    now.mover = ThingTrack::kAtRest;
    ++now.next;
  }
}

void ThingStage::record() {
  for (std::size_t i = 0; i < size(); ++i) tracks_[i].add(now_[i].pose, now_[i].mover);
}

}  // namespace pf::simulator
