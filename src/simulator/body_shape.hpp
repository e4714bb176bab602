// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulator/outfit.hpp"
#include "simulator/rig.hpp"

namespace pf::simulator {

/// A rounded limb: a segment with a radius at both ends, squashed along its axes x, y, z.
struct Blob {
  Bone bone = Bone::pelvis;
  Eigen::Vector3f a;
  Eigen::Vector3f b;
  float radius_a = 0.0F;
  float radius_b = 0.0F;
  Eigen::Vector3f squash = Eigen::Vector3f::Ones();

  /// About the distance to the surface, negative inside, metres.
  float distance(const Eigen::Vector3f& p) const;
};

/// The smaller of two distances, rounded where they are within `k`.
float smoothMin(float a, float b, float k);

/// Pieces of the clothed body without head and hands.
std::vector<Blob> bodyBlobs(const Rig& rig, const Outfit& outfit);
std::vector<Blob> handBlobs(const Rig& rig, float side);

/// Distances to the head's skin and to its hair, rest frame.
struct HeadShape {
  HeadShape(const Rig& rig, const Outfit& outfit);
  float skin(const Eigen::Vector3f& p) const;
  float hair(const Eigen::Vector3f& p) const;

 private:
  Rig rig_;
  HairStyle style_;
};

}  // namespace pf::simulator
