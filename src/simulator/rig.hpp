// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "posefusion/pose/skeleton.hpp"

namespace pf::simulator {

enum class Bone : int {
  pelvis,
  spine,
  chest,
  neck,
  head,
  left_upper_arm,
  left_forearm,
  left_hand,
  right_upper_arm,
  right_forearm,
  right_hand,
  left_thigh,
  left_shin,
  left_foot,
  right_thigh,
  right_shin,
  right_foot,
  burden  ///< what both hands carry
};
constexpr int kBoneCount = 18;

constexpr std::size_t index(Bone bone) { return static_cast<std::size_t>(bone); }
constexpr std::size_t index(Joint joint) { return static_cast<std::size_t>(joint); }

/// How a person is made.
struct Build {
  double height_m = 1.75;
  double stoutness = 1.0;  ///< girth over height, 1 = average
  bool feminine = false;   ///< narrower shoulders, wider hips
};

/// Where each bone has been moved to: rest point -> world point.
using Posture = std::array<Eigen::Isometry3f, kBoneCount>;

/// The skeleton at rest: standing at the origin facing +x, z up, arms 45 degrees out, metres.
/// Lengths after Drillis and Contini (1966), as fractions of the height.
struct Rig {
  explicit Rig(const Build& build);

  Build build;
  std::array<Eigen::Vector3f, kBoneCount> start;  ///< the joint each bone turns about
  std::array<Eigen::Vector3f, kBoneCount> end;
  std::array<Eigen::Vector3f, kJointCount> joints;  ///< COCO-18 joints at rest
  static const std::array<Bone, kJointCount> kBoneOfJoint;
  static const std::array<int, kBoneCount> kParent;  ///< -1: none

  float scale() const { return static_cast<float>(build.height_m / 1.75); }
  /// Direction of an arm at rest; `side` +1 left, -1 right.
  static Eigen::Vector3f armDirection(float side) {
    return {0.0F, side * 0.70710678F, -0.70710678F};
  }
};

}  // namespace pf::simulator
