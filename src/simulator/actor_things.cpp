// SPDX-License-Identifier: BSD-3-Clause
// What a person does with things: takes, carries, puts down, pushes, swings.
#include <algorithm>
#include <cmath>
#include <limits>

#include "simulator/actor.hpp"
#include "simulator/easing.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kArms_m = 0.34;        // from the body to the near side of what is pushed
constexpr double kBelly_m = 0.17;       // from the body to the near side of what is carried
constexpr double kHandOnDoor_m = 0.62;  // the hand lets a handle go that is farther away
constexpr double kWalk_m_s = 0.9;       // to a thing
constexpr int kSides = 16;              // from which a thing may be reached

double directionTo(const Vector2d& to, const Vector2d& from) {
  const Vector2d d = to - from;
  return std::atan2(d.y(), d.x());
}

/// `to`, turned by whole turns to be within half a turn of `from`.
ThingPose nearestTurn(const ThingPose& from, ThingPose to) {
  to.yaw_rad = from.yaw_rad + std::remainder(to.yaw_rad - from.yaw_rad, 2.0 * M_PI);
  return to;
}

}  // namespace

/// Free floor around a place, as near to it as can be reached and on the person's side.
Vector2d Actor::spotAt(const Vector2d& place, double reach_m) const {
  for (double radius = reach_m; radius < reach_m + 0.6; radius += 0.1) {
    double best = std::numeric_limits<double>::infinity();
    Vector2d spot = place;
    for (int i = 0; i < kSides; ++i) {
      const Vector2d p = place + radius * direction(2.0 * M_PI * i / kSides);
      const double far = (p - state_.at).norm();
      if (!walkway_->isFree(p) || far >= best) continue;
      best = far;
      spot = p;
    }
    if (std::isfinite(best)) return spot;
  }
  return walkway_->nearestFree(place);
}

void Actor::planThing() {
  const Action& a = action();
  const ThingPose& now = things_->pose(a.thing);
  const Vector2d at = now.at_m.head<2>();
  rest_ = now;
  if (a.kind == Action::Kind::take) {
    const double half = things_->halfExtent(a.thing, directionTo(at, state_.at));
    spot_ = spotAt(at, half + kBelly_m + 0.12);
    spot_yaw_ = directionTo(at, spot_);
  } else if (a.kind == Action::Kind::put) {
    const double half = things_->halfExtent(a.thing, now.yaw_rad - in_body_.yaw_rad);
    rest_.at_m = a.at_m;
    spot_ = spotAt(a.at_m.head<2>(), half + kBelly_m + 0.12);
    spot_yaw_ = directionTo(a.at_m.head<2>(), spot_);
    rest_.yaw_rad = a.turns ? a.yaw_rad : spot_yaw_ + in_body_.yaw_rad;
  } else if (a.kind == Action::Kind::push) {
    spot_yaw_ = directionTo(a.path_m.front().head<2>(), at);
    spot_ = at - (things_->halfExtent(a.thing, spot_yaw_) + kArms_m) * direction(spot_yaw_);
  } else {
    spot_ = state_.at;
    spot_yaw_ = directionTo(handleOf(now).head<2>(), state_.at);
  }
  way_ = walkway_->findWay(state_.at, spot_);
}

bool Actor::goTo(const Vector2d& spot, double yaw, double speed,
                 const std::vector<Vector2d>& others) {
  if ((spot - state_.at).norm() > 0.08) {
    walk(spot, speed, others);
    return false;
  }
  state_.speed_m_s = 0.0;
  return turnTo(yaw);
}

bool Actor::playThing(const std::vector<Vector2d>& others) {
  switch (action().kind) {
    case Action::Kind::take:
      return playTake(others);
    case Action::Kind::put:
      return playPut(others);
    case Action::Kind::push:
      return playPush(others);
    default:
      return playSwing();
  }
}

bool Actor::playTake(const std::vector<Vector2d>& others) {
  const std::size_t thing = action().thing;
  if (phase_ == 0) {
    if (things_->isBusy(thing) || !goTo(spot_, spot_yaw_, kWalk_m_s, others)) return false;
    if (!(things_->pose(thing) == rest_)) {  // it has gone elsewhere
      planThing();
      return false;
    }
    thing_ = thing;
    phase_ = 1;
  }
  const double low = std::clamp((0.75 - rest_.at_m.z()) / 0.5, 0.0, 1.0);
  if (phase_ == 1) {
    grasp_wanted_ = 1.0;
    crouch_wanted_ = low;
    graspSides(rest_);
    if (state_.grasp < 1.0 || state_.crouch < low - 0.02) return false;
    things_->take(thing, number_);
    const double half = things_->halfExtent(thing, state_.yaw);
    in_body_ = {Vector3d(half + kBelly_m, 0.0, 0.0), rest_.yaw_rad - state_.yaw};
    grip_ = Grip::lifts;
    grip_s_ = 0.0;
    phase_ = 2;
  }
  return grip_s_ >= kLift_s && state_.crouch < 0.02;
}

bool Actor::playPut(const std::vector<Vector2d>& others) {
  if (phase_ == 0) {
    if (!goTo(spot_, spot_yaw_, kWalk_m_s, others)) return false;
    rest_ = nearestTurn(carriedPose(), rest_);
    grip_ = Grip::lowers;
    grip_s_ = 0.0;
    phase_ = 1;
  }
  if (phase_ == 1) {
    crouch_wanted_ = std::clamp((0.75 - rest_.at_m.z()) / 0.5, 0.0, 1.0);
    if (grip_s_ < kLift_s || state_.crouch < crouch_wanted_ - 0.02) return false;
    things_->put(thing_, rest_);
    things_->leave(thing_);
    grip_ = Grip::none;
    grasp_wanted_ = 0.0;
    phase_ = 2;
  }
  return state_.grasp < 0.3 && state_.crouch < 0.02;
}

bool Actor::playPush(const std::vector<Vector2d>& others) {
  const Action& a = action();
  if (phase_ == 0) {
    if (things_->isBusy(a.thing) || !goTo(spot_, spot_yaw_, kWalk_m_s, others)) return false;
    phase_ = 1;
  }
  if (phase_ == 1) {
    grasp_wanted_ = 1.0;
    graspBack(things_->pose(a.thing));
    if (state_.grasp < 1.0) return false;
    const ThingPose& pose = things_->pose(a.thing);
    const Vector2d d = Eigen::Rotation2Dd(-state_.yaw) * (pose.at_m.head<2>() - state_.at);
    in_body_ = {Vector3d(d.x(), d.y(), pose.at_m.z()), pose.yaw_rad - state_.yaw};
    things_->take(a.thing, number_);
    thing_ = a.thing;
    grip_ = Grip::pushes;
    way_ = {state_.at};
    Vector2d from = pose.at_m.head<2>();
    for (const Vector3d& place : a.path_m) {
      const Vector2d to = place.head<2>();
      spot_yaw_ = directionTo(to, from);
      way_.push_back(to - d.norm() * direction(spot_yaw_));
      from = to;
    }
    leg_ = 1;
    phase_ = 2;
  }
  if (phase_ == 2) {
    if (!goTo(way_.back(), spot_yaw_, a.speed_m_s, {})) return false;
    things_->leave(thing_);
    grip_ = Grip::none;
    grasp_wanted_ = 0.0;
    phase_ = 3;
  }
  return state_.grasp < 0.3;
}

bool Actor::playSwing() {
  const Action& a = action();
  state_.speed_m_s = 0.0;
  if (phase_ == 0) {
    if (things_->isBusy(a.thing) || !turnTo(spot_yaw_)) return false;
    rest_ = things_->pose(a.thing);
    state_.reach_at = handleOf(rest_);
    phase_ = 1;
  }
  if (phase_ == 1) {
    reach_wanted_ = 1.0;
    if (state_.reach < 1.0) return false;
    things_->take(a.thing, number_);
    thing_ = a.thing;
    grip_ = Grip::swings;
    grip_s_ = 0.0;
    phase_ = 2;
  }
  if (phase_ == 2) {
    const Vector2d far = handleOf(swungPose(grip_s_ / a.for_s)).head<2>() - state_.at;
    reach_wanted_ = far.norm() < kHandOnDoor_m ? 1.0 : 0.0;
    if (grip_s_ < a.for_s) return false;
    things_->put(thing_, swungPose(1.0));
    things_->leave(thing_);
    grip_ = Grip::none;
    phase_ = 3;
  }
  return state_.reach < 0.3;
}

}  // namespace pf::simulator
