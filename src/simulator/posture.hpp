// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulator/crowd.hpp"
#include "simulator/rig.hpp"

namespace pf::simulator {

/// The middle joint of a limb of two bones from `root` towards `target`, bent towards `pole`. The
/// target is moved into reach.
struct LimbPose {
  Eigen::Vector3f middle;
  Eigen::Vector3f end;
  Eigen::Vector3f hinge;  ///< axis the middle joint turns about
};
LimbPose solveLimb(const Eigen::Vector3f& root, const Eigen::Vector3f& target,
                   const Eigen::Vector2f& lengths, const Eigen::Vector3f& pole);

/// Bones for a state: feet stand where they were put, hands go where they are wanted, the head
/// looks ahead; small movements of breathing and balance by `seed`.
Posture poseBody(const Rig& rig, const ActorState& state, std::uint32_t seed);

/// COCO-18 joints in the world.
std::array<Eigen::Vector3f, kJointCount> jointsOf(const Rig& rig, const Posture& posture);

}  // namespace pf::simulator
