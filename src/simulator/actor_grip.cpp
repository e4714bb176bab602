// SPDX-License-Identifier: BSD-3-Clause
// What is held follows the body, and the hands what is held.
#include <algorithm>
#include <cmath>

#include "simulator/actor.hpp"
#include "simulator/easing.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

}  // namespace

ThingPose Actor::carriedPose() const {
  const double s = rig_.scale(), crouch = smooth(state_.crouch);
  const double height = things_->box(thing_).sizes().z();
  ThingPose pose;
  pose.at_m.head<2>() = state_.at + (in_body_.at_m.x() + 0.1 * crouch) * direction(state_.yaw);
  pose.at_m.z() = state_.pelvis_m + 0.16 * s - 0.5 * height - 0.42 * s * crouch;
  pose.yaw_rad = state_.yaw + in_body_.yaw_rad;
  return pose;
}

ThingPose Actor::pushedPose() const {
  ThingPose pose = in_body_;
  const Vector2d at = Eigen::Rotation2Dd(state_.yaw) * in_body_.at_m.head<2>();
  pose.at_m.head<2>() = state_.at + at;
  pose.yaw_rad += state_.yaw;
  return pose;
}

ThingPose Actor::swungPose(double t) const {
  ThingPose pose = rest_;
  pose.yaw_rad += smooth(std::clamp(t, 0.0, 1.0)) * action().turn_rad;
  const Vector2d& hinge = things_->spec(action().thing).hinge_m;
  const Vector3d lever(hinge.x(), hinge.y(), 0.0);
  pose.at_m += rest_.matrix().linear() * lever - pose.matrix().linear() * lever;
  return pose;
}

/// Opposite the hinge, on the person's side.
Vector3d Actor::handleOf(const ThingPose& pose) const {
  const Vector2d& hinge = things_->spec(action().thing).hinge_m;
  const Vector3d handle = pose.matrix() * Vector3d(-0.85 * hinge.x(), -0.85 * hinge.y(), 1.03);
  return handle;
}

void Actor::graspSides(const ThingPose& pose) {
  const Vector2d left = direction(state_.yaw + 0.5 * M_PI);
  const double half = things_->halfExtent(thing_, state_.yaw + 0.5 * M_PI);
  const double up = 0.55 * things_->box(thing_).sizes().z();
  for (std::size_t side = 0; side < 2; ++side) {
    state_.grasp_at[side] = pose.at_m;
    state_.grasp_at[side].head<2>() += (side == 0 ? half : -half) * left;
    state_.grasp_at[side].z() += up;
  }
}

void Actor::graspBack(const ThingPose& pose) {
  const Vector2d left = direction(state_.yaw + 0.5 * M_PI);
  const std::size_t thing = action().thing;
  const double half = std::min(0.22, things_->halfExtent(thing, state_.yaw + 0.5 * M_PI));
  const double near = things_->halfExtent(thing, state_.yaw);
  const double up = std::min(things_->box(thing).max().z(), 0.98 * rig_.scale());
  for (std::size_t side = 0; side < 2; ++side) {
    Vector3d& hand = state_.grasp_at[side];
    hand = pose.at_m + Vector3d(0, 0, up);
    hand.head<2>() += (side == 0 ? half : -half) * left - near * direction(state_.yaw);
  }
}

void Actor::carry() {
  if (grip_ == Grip::none) return;
  grip_s_ += kActorStep_s;
  const double t = smooth(std::clamp(grip_s_ / kLift_s, 0.0, 1.0));
  ThingPose pose = carriedPose();
  if (grip_ == Grip::lifts) pose = interpolate(rest_, pose, t);
  if (grip_ == Grip::lifts && grip_s_ >= kLift_s) grip_ = Grip::follows;
  if (grip_ == Grip::lowers) pose = interpolate(pose, rest_, t);
  if (grip_ == Grip::pushes) pose = pushedPose();
  if (grip_ == Grip::swings) pose = swungPose(grip_s_ / action().for_s);
  things_->put(thing_, pose);
  if (grip_ == Grip::swings) {
    if (reach_wanted_ > 0.0) state_.reach_at = handleOf(pose);
  } else if (grip_ == Grip::pushes) {
    graspBack(pose);
  } else {
    graspSides(pose);
  }
}

}  // namespace pf::simulator
