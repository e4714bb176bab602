// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/loose_posture.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace pf::simulator {
namespace {

using Eigen::AngleAxisf;
using Eigen::Isometry3f;
using Eigen::Vector3f;

Bone next(Bone bone, int n) { return static_cast<Bone>(static_cast<int>(bone) + n); }

/// Turns bones about the joint at which the first of them begins.
void turn(const Rig& rig, const AngleAxisf& rotation, std::initializer_list<Bone> bones,
          Posture& posture) {
  const Bone first = *bones.begin();
  const Vector3f pivot = posture[index(first)] * rig.start[index(first)];
  Isometry3f motion = Isometry3f::Identity();
  motion.translate(pivot).rotate(rotation).translate(-pivot);
  for (const Bone bone : bones) {
    Isometry3f& t = posture[index(bone)];
    // Not a product of isometries: a burden that is not carried is scaled down.
    t.translation() = motion * t.translation();
    t.linear() = motion.linear() * t.linear();
  }
}

AngleAxisf anyTurn(Dice& dice, double most_rad) {
  const Vector3f axis{gaussian(dice.next()), gaussian(dice.next()), gaussian(dice.next())};
  const float angle = random(dice, 0.0, most_rad);
  return {angle, (axis + Vector3f(1e-3F, 0, 0)).normalized()};
}

/// Lowest of the joints and ends of bones, metres.
float lowest(const Rig& rig, const Posture& posture) {
  float low = 1e9F;
  for (std::size_t bone = 0; bone < posture.size(); ++bone) {
    if (bone == index(Bone::burden)) continue;
    for (const Vector3f& p : {rig.start[bone], rig.end[bone]}) {
      low = std::min(low, (posture[bone] * p).z());
    }
  }
  return low;
}

void settle(const Rig& rig, float floor_m, Posture& posture) {
  Isometry3f up = Isometry3f::Identity();
  up.translation().z() = floor_m + 0.08F - lowest(rig, posture);
  moveBody(up, posture);
}

}  // namespace

void moveBody(const Isometry3f& motion, Posture& posture) {
  for (Isometry3f& t : posture) {
    t.translation() = motion * t.translation();
    t.linear() = motion.linear() * t.linear();
  }
}

void loosen(const Rig& rig, Posture& posture, bool legs, Dice& dice) {
  for (const Bone upper : {Bone::left_upper_arm, Bone::right_upper_arm}) {
    const Bone fore = next(upper, 1), hand = next(upper, 2);
    if (dice.chance(0.35)) turn(rig, anyTurn(dice, 1.7), {upper, fore, hand}, posture);
    if (dice.chance(0.35)) turn(rig, anyTurn(dice, 1.2), {fore, hand}, posture);
    if (dice.chance(0.3)) turn(rig, anyTurn(dice, 0.6), {hand}, posture);
  }
  const Vector3f left = posture[index(Bone::pelvis)].linear() * Vector3f::UnitY();
  if (dice.chance(0.25)) {
    turn(rig, AngleAxisf(random(dice, -0.3, 1.2), left),
         {Bone::spine, Bone::chest, Bone::neck, Bone::head, Bone::left_upper_arm,
          Bone::left_forearm, Bone::left_hand, Bone::right_upper_arm, Bone::right_forearm,
          Bone::right_hand, Bone::burden},
         posture);
  }
  if (dice.chance(0.4)) turn(rig, anyTurn(dice, 0.8), {Bone::neck, Bone::head}, posture);
  if (!legs) return;
  for (const Bone thigh : {Bone::left_thigh, Bone::right_thigh}) {
    const Bone shin = next(thigh, 1), foot = next(thigh, 2);
    turn(rig, anyTurn(dice, 0.7), {thigh, shin, foot}, posture);
    turn(rig, AngleAxisf(random(dice, -0.2, 1.5), left), {shin, foot}, posture);
  }
}

void layDown(const Rig& rig, float floor_m, Dice& dice, Posture& posture) {
  const float side = static_cast<float>(dice.below(4)) * 1.5708F + random(dice, -0.3, 0.3);
  Isometry3f motion = Isometry3f::Identity();
  motion.rotate(AngleAxisf(random(dice, 1.35, 1.6), Vector3f::UnitY()));
  motion.rotate(AngleAxisf(side, Vector3f::UnitZ()));
  motion.translate(Vector3f(0, 0, -0.9F * rig.scale()));
  moveBody(motion, posture);
  settle(rig, floor_m, posture);
}

void topple(const Rig& rig, float angle_rad, Dice& dice, Posture& posture) {
  Isometry3f motion = Isometry3f::Identity();
  const float way = random(dice, 0.0, 6.2831);
  motion.rotate(AngleAxisf(angle_rad, Vector3f(std::cos(way), std::sin(way), 0)));
  moveBody(motion, posture);
  settle(rig, 0.0F, posture);
}

}  // namespace pf::simulator
