// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/posture.hpp"

#include <algorithm>
#include <cmath>

#include "simulator/actor.hpp"
#include "simulator/easing.hpp"
#include "simulator/random.hpp"

namespace pf::simulator {
namespace {

using Eigen::AngleAxisf;
using Eigen::Matrix3f;
using Eigen::Vector2f;
using Eigen::Vector3f;

float smoothFloat(double t) { return static_cast<float>(smooth(t)); }

Matrix3f about(float angle, const Vector3f& axis) {
  return AngleAxisf(angle, axis).toRotationMatrix();
}

/// Turns the rest direction and hinge of a bone into the posed ones.
Matrix3f turning(const Vector3f& from, const Vector3f& from_hinge, const Vector3f& to,
                 const Vector3f& to_hinge) {
  Matrix3f a, b;
  const Vector3f hinge_a = (from_hinge - from_hinge.dot(from) * from).normalized();
  const Vector3f hinge_b = (to_hinge - to_hinge.dot(to) * to).normalized();
  a << from, hinge_a, from.cross(hinge_a);
  b << to, hinge_b, to.cross(hinge_b);
  return b * a.transpose();
}

/// Slow irregular movement in [-1, 1]: several a few seconds long, by seed.
float drift(std::uint32_t seed, double time_s, double period_s) {
  return 1.8F * fractalNoise(static_cast<float>(time_s / period_s), 0.5F, seed, 2);
}

/// Builds the bones one by one.
class Poser {
 public:
  Poser(const Rig& rig, const ActorState& state, std::uint32_t seed)
      : rig_(rig), state_(state), seed_(seed) {}

  Posture pose() {
    poseTrunk();
    for (const float side : {1.0F, -1.0F}) {
      poseLeg(side);
      poseArm(side);
    }
    poseBurden();
    return posture_;
  }

 private:
  void place(Bone bone, const Matrix3f& rotation, const Vector3f& start) {
    Eigen::Isometry3f& t = posture_[index(bone)];
    t = Eigen::Isometry3f::Identity();
    t.linear() = rotation;
    t.translation() = start - rotation * rig_.start[index(bone)];
  }
  Vector3f attached(Bone parent, Bone child) const {
    return posture_[index(parent)] * rig_.start[index(child)];
  }
  float forwardOf(std::size_t foot) const {
    const Eigen::Vector2d d = state_.feet[foot].at - state_.at;
    return static_cast<float>(d.x() * std::cos(state_.yaw) + d.y() * std::sin(state_.yaw));
  }

  void poseTrunk();
  void poseLeg(float side);
  void poseArm(float side);
  void poseBurden();
  Vector3f swungHand(float side, const Vector3f& shoulder) const;
  Vector3f wantedHand(float side, const Vector3f& shoulder) const;

  const Rig& rig_;
  const ActorState& state_;
  std::uint32_t seed_;
  Posture posture_;
  Matrix3f yaw_ = Matrix3f::Identity();
};

void Poser::poseTrunk() {
  const float s = rig_.scale();
  const double time = state_.time_s;
  const float sit = smoothFloat(state_.sit), crouch = smoothFloat(state_.crouch);
  yaw_ = about(static_cast<float>(state_.yaw), Vector3f::UnitZ());
  Vector3f hips(static_cast<float>(state_.at.x()), static_cast<float>(state_.at.y()),
                static_cast<float>(state_.pelvis_m));
  hips += yaw_ * Vector3f(-sit * static_cast<float>(kSeatBehind_m) * s - 0.13F * crouch, 0, 0);
  const float seated = static_cast<float>(state_.seat_m) + 0.095F * s;
  hips.z() += sit * (seated - hips.z());
  hips.z() -= crouch * 0.42F * s;
  hips +=
      yaw_ * Vector3f(0.008F * drift(seed_ + 1U, time, 3.0), 0.014F * drift(seed_, time, 4.0), 0);
  const float rising = 4.0F * sit * (1.0F - sit);
  const float lean = 0.04F * static_cast<float>(state_.speed_m_s) + 0.65F * rising - 0.10F * sit +
                     0.55F * crouch + 0.45F * crouch * smoothFloat(state_.grasp) +
                     0.16F * smoothFloat(state_.reach) - 0.05F * smoothFloat(state_.carry) +
                     0.03F * drift(seed_ + 2U, time, 5.0);
  const float stride = forwardOf(0) - forwardOf(1);
  const float twist = -0.16F * std::clamp(stride, -0.8F, 0.8F) * (1.0F - sit);
  const Vector3f x = Vector3f::UnitX(), y = Vector3f::UnitY(), z = Vector3f::UnitZ();
  const float sway = 0.03F * drift(seed_ + 3U, time, 6.0);
  const Matrix3f pelvis = yaw_ * about(-twist, z) * about(0.35F * lean - 0.25F * sit, y);
  place(Bone::pelvis, pelvis, hips + Vector3f(0, 0, 0.01F * s));
  const Matrix3f spine = yaw_ * about(0.7F * lean - 0.08F * sit, y) * about(sway, x);
  place(Bone::spine, spine, attached(Bone::pelvis, Bone::spine));
  const Matrix3f chest = yaw_ * about(twist + 0.05F * drift(seed_ + 4U, time, 4.0), z) *
                         about(lean, y) * about(sway, x);
  place(Bone::chest, chest, attached(Bone::spine, Bone::chest));
  const float talk = smoothFloat(state_.talk);
  const float look = 0.30F * drift(seed_ + 5U, time, 2.6) + 0.15F * talk * drift(seed_, time, 0.8);
  const float nod =
      0.10F * drift(seed_ + 6U, time, 2.0) + 0.06F * talk * drift(seed_ + 7U, time, 0.5);
  place(Bone::neck, yaw_ * about(0.4F * look, z) * about(0.45F * lean, y),
        attached(Bone::chest, Bone::neck));
  place(Bone::head, yaw_ * about(look, z) * about(0.12F * lean + nod + 0.25F * crouch, y),
        attached(Bone::neck, Bone::head));
}

void Poser::poseLeg(float side) {
  const auto thigh = side > 0 ? Bone::left_thigh : Bone::right_thigh;
  const auto shin = side > 0 ? Bone::left_shin : Bone::right_shin;
  const auto foot = side > 0 ? Bone::left_foot : Bone::right_foot;
  const FootState& f = state_.feet[side > 0 ? 0 : 1];
  const float s = rig_.scale();
  const float yaw = static_cast<float>(f.yaw), pitch = static_cast<float>(f.pitch);
  const Matrix3f sole = about(yaw, Vector3f::UnitZ()) * about(pitch, Vector3f::UnitY());
  // The foot rolls over its ball when the heel rises, over its heel when the toes do.
  const float pivot = pitch > 0.0F ? 0.12F * s : -0.03F * s;
  const Vector3f lever(-pivot, 0, 0.085F * s);
  Vector3f ankle(static_cast<float>(f.at.x()), static_cast<float>(f.at.y()),
                 static_cast<float>(f.lift_m));
  ankle += about(yaw, Vector3f::UnitZ()) * Vector3f(pivot, 0, 0) + sole * lever;
  const Vector3f hip = attached(Bone::pelvis, thigh);
  const Vector2f lengths((rig_.end[index(thigh)] - rig_.start[index(thigh)]).norm(),
                         (rig_.end[index(shin)] - rig_.start[index(shin)]).norm());
  const Vector3f pole = about(0.5F * (yaw + static_cast<float>(state_.yaw)), Vector3f::UnitZ()) *
                        Vector3f(1.0F, side * 0.08F, 0.25F);
  const LimbPose limb = solveLimb(hip, ankle, lengths, pole);
  const Vector3f down_a = (rig_.end[index(thigh)] - rig_.start[index(thigh)]).normalized();
  const Vector3f down_b = (rig_.end[index(shin)] - rig_.start[index(shin)]).normalized();
  place(thigh, turning(down_a, Vector3f::UnitY(), (limb.middle - hip).normalized(), limb.hinge),
        hip);
  place(shin, turning(down_b, Vector3f::UnitY(), (limb.end - limb.middle).normalized(), limb.hinge),
        limb.middle);
  place(foot, sole, limb.end);
}

Vector3f Poser::swungHand(float side, const Vector3f& shoulder) const {
  const std::size_t other = side > 0 ? 1 : 0;
  const float angle =
      std::clamp(1.0F * forwardOf(other), -0.5F, 0.6F) *
          std::min(1.0F, static_cast<float>(state_.speed_m_s) * 1.2F) +
      0.05F * drift(seed_ + 8U + static_cast<std::uint32_t>(other), state_.time_s, 3.0);
  const float length = rig_.scale() * 0.545F;
  const float bend = 0.955F - 0.05F * std::max(0.0F, angle);
  const Matrix3f& chest = posture_[index(Bone::chest)].linear();
  const Matrix3f frame = yaw_ * (0.3F * (yaw_.transpose() * chest) + 0.7F * Matrix3f::Identity());
  return shoulder + frame * (about(-angle - 0.06F, Vector3f::UnitY()) *
                             Vector3f(0.02F, side * 0.13F, -1.0F).normalized() * bend * length);
}

Vector3f Poser::wantedHand(float side, const Vector3f& shoulder) const {
  const float s = rig_.scale();
  Vector3f hand = swungHand(side, shoulder);
  const auto blend = [&](const Vector3f& to, double amount) {
    hand += smoothFloat(amount) * (to - hand);
  };
  const auto thigh = side > 0 ? Bone::left_thigh : Bone::right_thigh;
  const Vector3f lap = posture_[index(thigh)] *
                       (rig_.start[index(thigh)] + s * Vector3f(0.115F, -side * 0.01F, -0.26F));
  blend(lap, state_.sit);
  const Eigen::Isometry3f& chest = posture_[index(Bone::chest)];
  const auto noise = [&](std::uint32_t salt) {
    return drift(hash(seed_, salt, side > 0 ? 1U : 2U), state_.time_s, 0.9);
  };
  const Vector3f talking(0.27F + 0.13F * noise(11U), side * (0.20F + 0.10F * noise(12U)),
                         1.14F + 0.16F * noise(13U));
  blend(chest * (s * talking), state_.talk * std::clamp(0.75 + 0.4 * noise(14U), 0.0, 1.0));
  blend(chest * (s * Vector3f(0.33F, side * 0.17F, 1.06F)), state_.carry);
  const Vector3f knee = chest * (s * Vector3f(0.30F, side * 0.16F, 0.98F));
  blend(knee, state_.crouch);
  // The nearer hand reaches.
  const Vector3f goal = state_.reach_at.cast<float>();
  const float lateral = (yaw_.transpose() * (goal - hand)).y();
  if (side * (lateral + 0.02F) > 0.0F) blend(goal, state_.reach);
  blend(state_.grasp_at[side > 0 ? 0 : 1].cast<float>(), state_.grasp);
  return hand;
}

void Poser::poseBurden() {
  // It appears in the hands when they are ready, and is hidden in the chest otherwise, small but
  // not a point: Embree stops the program where boxes to be parted have no extent.
  const Eigen::Isometry3f& chest = posture_[index(Bone::chest)];
  Eigen::Isometry3f& burden = posture_[index(Bone::burden)];
  burden = chest;
  if (state_.carry > 0.85) return;
  burden.linear() *= 0.02F;
  const float s = rig_.scale();
  burden.translation() =
      chest * (s * Vector3f(0, 0, 1.3F)) - burden.linear() * rig_.start[index(Bone::burden)];
}

void Poser::poseArm(float side) {
  const auto upper = side > 0 ? Bone::left_upper_arm : Bone::right_upper_arm;
  const auto fore = side > 0 ? Bone::left_forearm : Bone::right_forearm;
  const auto hand = side > 0 ? Bone::left_hand : Bone::right_hand;
  const Vector3f shoulder = attached(Bone::chest, upper);
  const Vector3f wrist = wantedHand(side, shoulder);
  const Vector2f lengths((rig_.end[index(upper)] - rig_.start[index(upper)]).norm(),
                         (rig_.end[index(fore)] - rig_.start[index(fore)]).norm());
  const Vector3f pole = yaw_ * Vector3f(-0.75F, side * 0.45F, -0.35F);
  const LimbPose limb = solveLimb(shoulder, wrist, lengths, pole);
  const Vector3f rest = Rig::armDirection(side);
  const Vector3f hinge = rest.cross(Vector3f::UnitX());
  place(upper, turning(rest, hinge, (limb.middle - shoulder).normalized(), limb.hinge), shoulder);
  const Matrix3f forearm = turning(rest, hinge, (limb.end - limb.middle).normalized(), limb.hinge);
  place(fore, forearm, limb.middle);
  place(hand, forearm, limb.end);
}

}  // namespace

LimbPose solveLimb(const Vector3f& root, const Vector3f& target, const Vector2f& lengths,
                   const Vector3f& pole) {
  const float a = lengths.x(), b = lengths.y();
  const Vector3f d = target - root;
  const float wanted = d.norm();
  const Vector3f along = wanted > 1e-4F ? Vector3f(d / wanted) : Vector3f(-Vector3f::UnitZ());
  const float distance = std::clamp(wanted, 1.02F * std::abs(a - b) + 1e-3F, 0.998F * (a + b));
  const float cosine = (a * a + distance * distance - b * b) / (2.0F * a * distance);
  const float sine = std::sqrt(std::max(0.0F, 1.0F - cosine * cosine));
  Vector3f side = pole - pole.dot(along) * along;
  if (side.norm() < 1e-4F) side = along.unitOrthogonal();
  side.normalize();
  return {root + a * (cosine * along + sine * side), root + distance * along, side.cross(along)};
}

Posture poseBody(const Rig& rig, const ActorState& state, std::uint32_t seed) {
  return Poser(rig, state, seed).pose();
}

std::array<Vector3f, kJointCount> jointsOf(const Rig& rig, const Posture& posture) {
  std::array<Vector3f, kJointCount> joints;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    joints[j] = posture[index(Rig::kBoneOfJoint[j])] * rig.joints[j];
  }
  return joints;
}

}  // namespace pf::simulator
