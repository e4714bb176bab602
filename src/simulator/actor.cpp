// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/actor.hpp"
#include "simulator/easing.hpp"

#include <algorithm>
#include <cmath>

namespace pf::simulator {
namespace {

using Eigen::Vector2d;

/// Moves an amount towards what is wanted, within `seconds` from 0 to 1.
void approach(double& amount, double wanted, double seconds) {
  const double step = kActorStep_s / seconds;
  amount += std::clamp(wanted - amount, -step, step);
}

constexpr double kThingReach_m = 0.9;  // at which people walk round things that stand
constexpr double kKeepsRight_s = 2.0;  // after touching a wall: two people that meet there separate

/// Steering away from places ahead: to the right of those in the way, or always.
double evade(const ActorState& state, const std::vector<Vector2d>& others, bool keeps_right,
             double& slow) {
  double turn = 0.0;
  const Vector2d ahead = direction(state.yaw);
  for (const auto& other : others) {
    const Vector2d d = other - state.at;
    const double distance = d.norm();
    if (distance > 1.5 || distance < 1e-6) continue;
    const double cosine = d.dot(ahead) / distance;
    if (cosine < 0.3) continue;
    const double side = ahead.x() * d.y() - ahead.y() * d.x();  // > 0: on the left
    turn += (keeps_right || side > -0.08 ? -1.0 : 1.0) * 1.1 * cosine * (1.5 - distance);
    if (distance < 0.9) slow = std::min(slow, std::max(0.25, (distance - 0.45) / 0.45));
  }
  return turn;
}

}  // namespace

Actor::Actor(const PersonSpec& spec, const Walkway& walkway, ThingStage* things, std::size_t number)
    : spec_(spec), walkway_(&walkway), rig_(spec.build), things_(things), number_(number) {
  if (spec_.script.empty()) spec_.script.emplace_back();
  state_.at = spec.start_m;
  state_.yaw = spec.yaw_rad;
  const Action& first = spec_.script.front();
  if (first.kind == Action::Kind::sit) {  // seated from the beginning
    state_.yaw = first.yaw_rad;
    state_.at = first.at_m.head<2>() + rig_.scale() * kSeatBehind_m * direction(first.yaw_rad);
    state_.sit = 1.0;
    state_.seat_m = first.seat_m;
  }
  stepper_.reset(state_.at, state_.yaw, rig_.start[index(Bone::left_thigh)].y());
  state_.feet = stepper_.feet();
  state_.pelvis_m = rig_.start[index(Bone::left_thigh)].z();
  action_s_ = -spec.delay_s;
  begin();
}

const Action& Actor::action() const { return spec_.script[current_]; }

Vector2d Actor::bodyPlace() const {
  return state_.at - state_.sit * rig_.scale() * 0.25 * direction(state_.yaw);
}

void Actor::begin() {
  const Action& a = action();
  phase_ = 0;
  planWay();
  if (a.kind == Action::Kind::sit && state_.sit < 0.5) state_.seat_m = a.seat_m;
  carry_wanted_ = a.carries ? 1.0 : 0.0;
}

void Actor::planWay() {
  if (phase_ > 0) return;  // what is at a thing goes its way
  const Action& a = action();
  leg_ = 1;
  way_.clear();
  if (a.kind == Action::Kind::walk) way_ = walkway_->findWay(state_.at, a.at_m.head<2>());
  if (a.kind == Action::Kind::sit && state_.sit < 0.5) {
    const Vector2d front = a.at_m.head<2>() + rig_.scale() * kSeatBehind_m * direction(a.yaw_rad);
    way_ = walkway_->findWay(state_.at, front);
  }
  if (handlesThing()) planThing();
}

bool Actor::turnTo(double yaw) {
  const double error = std::remainder(yaw - state_.yaw, 2.0 * M_PI);
  state_.yaw += std::clamp(error, -2.0 * kActorStep_s, 2.0 * kActorStep_s);
  return std::abs(error) < 0.05;
}

std::vector<Vector2d> Actor::inTheWay(std::vector<Vector2d> others, const Vector2d& way) const {
  if (things_ == nullptr || handlesThing()) return others;
  for (const Vector2d& thing : things_->standingNear(state_.at, kThingReach_m)) {
    if ((thing - state_.at).dot(way) > 0.0) others.push_back(thing);
  }
  return others;
}

bool Actor::walk(const Vector2d& goal, double speed, const std::vector<Vector2d>& others) {
  while (leg_ + 1 < way_.size() && (way_[leg_] - state_.at).norm() < 0.25) ++leg_;
  const Vector2d target = leg_ + 1 < way_.size() ? way_[leg_] : goal;
  const Vector2d d = target - state_.at;
  const double left = (goal - state_.at).norm();
  if (left < 0.06) {
    state_.speed_m_s *= 0.8;
    return state_.speed_m_s < 0.05;
  }
  double slow = 1.0;
  const double evading =
      left > 0.5 ? evade(state_, inTheWay(others, d), keeps_right_s_ > 0.0, slow) : 0.0;
  const double wanted = std::atan2(d.y(), d.x()) + std::clamp(evading, -1.1, 1.1);
  const double error = std::remainder(wanted - state_.yaw, 2.0 * M_PI);
  const double rate = 2.6 * kActorStep_s;
  state_.yaw += std::clamp(0.12 * error, -rate, rate);
  const double facing = std::max(0.0, std::cos(error));
  const double braked = std::min(speed, std::sqrt(2.0 * 0.9 * left) + 0.05);
  const double want_speed = braked * facing * facing * slow;
  state_.speed_m_s +=
      std::clamp(want_speed - state_.speed_m_s, -2.0 * kActorStep_s, 1.2 * kActorStep_s);
  // Close to the goal the last steps go straight there, whatever the body faces.
  const Vector2d heading = left < 0.3 ? Vector2d(d.normalized()) : direction(state_.yaw);
  state_.at += std::max(state_.speed_m_s, left < 0.3 ? 0.15 : 0.0) * kActorStep_s * heading;
  return false;
}

bool Actor::playSit(const std::vector<Vector2d>& others) {
  const Action& a = action();
  const Vector2d front = a.at_m.head<2>() + rig_.scale() * kSeatBehind_m * direction(a.yaw_rad);
  if (action_s_ > a.for_s) {
    sit_wanted_ = 0.0;
    return state_.sit <= 0.0;
  }
  if (state_.sit <= 0.0) {
    action_s_ = 0.0;  // the time counts from the moment of sitting down
    if ((front - state_.at).norm() > 0.08) {
      walk(front, 0.9, others);
      return false;
    }
    state_.speed_m_s = 0.0;
    if (!turnTo(a.yaw_rad)) return false;
  }
  sit_wanted_ = 1.0;
  talk_wanted_ = a.gestures ? 1.0 : 0.0;
  return false;
}

bool Actor::play(const std::vector<Vector2d>& others) {
  const Action& a = action();
  sit_wanted_ = crouch_wanted_ = talk_wanted_ = reach_wanted_ = 0.0;
  if (a.kind == Action::Kind::walk) return walk(a.at_m.head<2>(), a.speed_m_s, others);
  if (a.kind == Action::Kind::sit) return playSit(others);
  if (handlesThing()) return playThing(others);
  state_.speed_m_s = 0.0;
  if (a.turns) turnTo(a.yaw_rad);
  const bool on = action_s_ < a.for_s;
  if (a.kind == Action::Kind::crouch) crouch_wanted_ = on ? 1.0 : 0.0;
  if (a.kind == Action::Kind::talk) talk_wanted_ = on ? 1.0 : 0.0;
  if (a.kind == Action::Kind::reach) {
    reach_wanted_ = on ? 1.0 : 0.0;
    state_.reach_at = a.at_m;
  }
  return !on && state_.crouch < 0.02 && state_.reach < 0.3;
}

void Actor::push(const Vector2d& by) {
  if (state_.sit > 0.0) return;
  const double step = 1.2 * kActorStep_s;
  const double length = by.norm();
  const Vector2d before = state_.at;
  state_.at += by * std::min(1.0, step / std::max(length, 1e-9));
  keepOffWalls(before);
}

/// A person that steps into a wall slides along it, and searches the way anew.
void Actor::keepOffWalls(const Vector2d& before) {
  if (walkway_->isFloor(state_.at) || !walkway_->isFloor(before)) return;
  const Vector2d along_x(state_.at.x(), before.y()), along_y(before.x(), state_.at.y());
  state_.at = walkway_->isFloor(along_x) ? along_x : walkway_->isFloor(along_y) ? along_y : before;
  if (keeps_right_s_ > 0.0) return;
  keeps_right_s_ = kKeepsRight_s;
  planWay();
}

void Actor::settleHeight() {
  const double s = rig_.scale(), leg = 0.99 * 0.835 * s;
  double hips = 0.912 * s;
  for (const auto& foot : state_.feet) {
    const double ankle = 0.085 * s + foot.lift_m + 0.10 * s * std::sin(std::max(0.0, foot.pitch));
    const double across = std::max(0.0, (foot.at - state_.at).norm() - 0.09 * s);
    hips = std::min(hips, ankle + std::sqrt(std::max(0.04, leg * leg - across * across)));
  }
  state_.pelvis_m += 0.35 * (hips - state_.pelvis_m);
}

void Actor::step(const std::vector<Vector2d>& others) {
  const Vector2d before = state_.at;
  state_.time_s += kActorStep_s;
  action_s_ += kActorStep_s;
  keeps_right_s_ -= kActorStep_s;
  if (action_s_ >= 0.0 && !over_ && play(others)) {
    action_s_ = 0.0;
    const bool last = current_ + 1 == spec_.script.size();
    over_ = last && !spec_.repeats;
    current_ = last ? (spec_.repeats ? 0 : current_) : current_ + 1;
    if (!over_) begin();
  }
  keepOffWalls(before);
  approach(state_.sit, sit_wanted_, 1.5);
  approach(state_.crouch, crouch_wanted_, 1.1);
  approach(state_.talk, talk_wanted_, 0.6);
  approach(state_.reach, reach_wanted_, 0.8);
  approach(state_.carry, carry_wanted_, 0.7);
  approach(state_.grasp, grasp_wanted_, 0.8);
  const Vector2d velocity = (state_.at - before) / kActorStep_s;
  stepper_.step(state_.at, state_.yaw, velocity);
  state_.feet = stepper_.feet();
  settleHeight();
}

}  // namespace pf::simulator
