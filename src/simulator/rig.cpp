// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/rig.hpp"

namespace pf::simulator {

using Eigen::Vector3f;

const std::array<Bone, kJointCount> Rig::kBoneOfJoint = {
    Bone::head,          Bone::chest,      Bone::right_upper_arm,
    Bone::right_forearm, Bone::right_hand, Bone::left_upper_arm,
    Bone::left_forearm,  Bone::left_hand,  Bone::right_thigh,
    Bone::right_shin,    Bone::right_foot, Bone::left_thigh,
    Bone::left_shin,     Bone::left_foot,  Bone::head,
    Bone::head,          Bone::head,       Bone::head};

const std::array<int, kBoneCount> Rig::kParent = {-1, 0, 1, 2,  3,  2, 5,  6,  2,
                                                  8,  9, 0, 11, 12, 0, 14, 15, 2};

Rig::Rig(const Build& b) : build(b) {
  const float s = scale();
  const float girth = static_cast<float>(b.stoutness);
  const float shoulder = (b.feminine ? 0.150F : 0.172F) * (0.7F + 0.3F * girth);
  const float hip = (b.feminine ? 0.095F : 0.090F) * (0.6F + 0.4F * girth);
  const auto set = [&](Bone bone, const Vector3f& from, const Vector3f& to) {
    start[index(bone)] = s * from;
    end[index(bone)] = s * to;
  };
  set(Bone::pelvis, {0, 0, 0.93F}, {0, 0, 1.00F});
  set(Bone::spine, {0, 0, 1.00F}, {0, 0, 1.18F});
  set(Bone::chest, {0, 0, 1.18F}, {-0.01F, 0, 1.45F});
  set(Bone::neck, {-0.01F, 0, 1.46F}, {0, 0, 1.55F});
  set(Bone::head, {0, 0, 1.56F}, {0, 0, 1.75F});
  set(Bone::burden, {0.43F, 0, 1.05F}, {0.43F, 0, 1.06F});
  for (const float side : {1.0F, -1.0F}) {
    const auto arm = side > 0 ? Bone::left_upper_arm : Bone::right_upper_arm;
    const auto leg = side > 0 ? Bone::left_thigh : Bone::right_thigh;
    const auto next = [](Bone bone, int n) {
      return static_cast<Bone>(static_cast<int>(bone) + n);
    };
    const Vector3f d = armDirection(side);
    const Vector3f top(-0.01F, side * shoulder, 1.425F);
    set(arm, top, top + 0.295F * d);
    set(next(arm, 1), top + 0.295F * d, top + 0.545F * d);
    set(next(arm, 2), top + 0.545F * d, top + 0.72F * d);
    const float y = side * hip;
    set(leg, {0, y, 0.92F}, {0, y, 0.50F});
    set(next(leg, 1), {0, y, 0.50F}, {-0.01F, y, 0.085F});
    set(next(leg, 2), {-0.01F, y, 0.085F}, {0.17F, y, 0.03F});
  }
  const auto joint = [&](Joint j, const Vector3f& p) { joints[index(j)] = s * p; };
  for (int j = 0; j < kJointCount; ++j) {
    joints[static_cast<std::size_t>(j)] = start[index(kBoneOfJoint[static_cast<std::size_t>(j)])];
  }
  joint(Joint::nose, {0.115F, 0, 1.61F});
  joints[index(Joint::neck)] =
      0.5F * (joints[index(Joint::right_shoulder)] + joints[index(Joint::left_shoulder)]);
  joint(Joint::right_eye, {0.085F, -0.032F, 1.637F});
  joint(Joint::left_eye, {0.085F, 0.032F, 1.637F});
  joint(Joint::right_ear, {-0.005F, -0.078F, 1.63F});
  joint(Joint::left_ear, {-0.005F, 0.078F, 1.63F});
}

}  // namespace pf::simulator
