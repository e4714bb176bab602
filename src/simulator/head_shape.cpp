// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "simulator/body_shape.hpp"
#include "simulator/random.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector3f;

Blob ball(const Vector3f& centre, float radius, const Vector3f& squash = Vector3f::Ones()) {
  return {Bone::head, centre, centre, radius, radius, squash};
}

Blob limb(const Vector3f& a, const Vector3f& b, float radius_a, float radius_b) {
  return {Bone::head, a, b, radius_a, radius_b};
}

/// Distance to the left half mirrored onto the right: the face is symmetric.
float mirrored(const Blob& blob, const Vector3f& p) {
  return blob.distance({p.x(), std::abs(p.y()), p.z()});
}

}  // namespace

HeadShape::HeadShape(const Rig& rig, const Outfit& outfit) : rig_(rig), style_(outfit.hair_style) {}

float HeadShape::skin(const Vector3f& at) const {
  // All sizes for a height of 1.75 m.
  static const Blob cranium = ball({-0.012F, 0, 1.658F}, 0.092F, {1.06F, 0.84F, 1.0F});
  static const Blob face = ball({0.026F, 0, 1.603F}, 0.085F, {0.80F, 0.71F, 1.0F});
  static const Blob jaw = limb({0.0F, 0.040F, 1.575F}, {0.058F, 0.012F, 1.540F}, 0.026F, 0.024F);
  static const Blob nose = limb({0.088F, 0, 1.645F}, {0.110F, 0, 1.607F}, 0.008F, 0.0125F);
  static const Blob nostril = ball({0.098F, 0.012F, 1.604F}, 0.0095F);
  static const Blob brow = limb({0.090F, 0.004F, 1.655F}, {0.074F, 0.044F, 1.653F}, 0.012F, 0.010F);
  static const Blob cheek = ball({0.058F, 0.040F, 1.603F}, 0.030F);
  static const Blob socket = ball({0.103F, 0.031F, 1.636F}, 0.019F);
  static const Blob eye = ball({0.0745F, 0.031F, 1.636F}, 0.0135F);
  static const Blob lips = limb({0.0865F, 0, 1.568F}, {0.074F, 0.024F, 1.568F}, 0.0100F, 0.006F);
  static const Blob ear = ball({-0.004F, 0.077F, 1.632F}, 0.031F, {0.66F, 0.28F, 1.0F});
  static const Blob neck = limb({-0.014F, 0, 1.45F}, {-0.012F, 0, 1.60F}, 0.056F, 0.050F);
  const float s = rig_.scale();
  const Vector3f p = at / s;
  float d = smoothMin(cranium.distance(p), face.distance(p), 0.035F);
  d = smoothMin(d, mirrored(jaw, p), 0.03F);
  d = smoothMin(d, mirrored(cheek, p), 0.025F);
  d = smoothMin(d, mirrored(brow, p), 0.014F);
  d = -smoothMin(-d, mirrored(socket, p), 0.012F);
  d = smoothMin(d, smoothMin(nose.distance(p), mirrored(nostril, p), 0.010F), 0.012F);
  d = smoothMin(d, mirrored(lips, p), 0.008F);
  d = std::min(d, mirrored(eye, p));
  d = smoothMin(d, neck.distance(p), 0.025F);
  d = smoothMin(d, mirrored(ear, p), 0.006F);
  return s * d;
}

float HeadShape::hair(const Vector3f& at) const {
  static const Blob cap = ball({-0.014F, 0, 1.662F}, 0.102F, {1.07F, 0.86F, 1.0F});
  static const Blob tight = ball({-0.013F, 0, 1.659F}, 0.096F, {1.07F, 0.86F, 1.0F});
  static const Blob fall = {Bone::head, {-0.035F, 0, 1.66F}, {-0.050F, 0, 1.47F}, 0.104F,
                            0.098F,     {0.72F, 0.98F, 1.0F}};
  if (style_ == HairStyle::bald) return 1.0F;
  const float s = rig_.scale();
  const Vector3f p = at / s;
  const Blob& volume = style_ == HairStyle::cropped ? tight : cap;
  // The hairline runs from the forehead down to behind the ears.
  const float high = style_ == HairStyle::cropped ? 1.712F : 1.704F;
  const float fringe =
      0.009F * latticeNoise(Vector3f(40.0F * p.x(), 90.0F * p.y(), 25.0F * p.z()), 5U);
  const float temple = 0.030F * std::clamp((std::abs(p.y()) - 0.045F) / 0.03F, 0.0F, 1.0F);
  const float line = 0.62F * (p.x() - 0.075F) - 0.785F * (p.z() - high) + fringe - temple;
  const float locks =
      0.004F * latticeNoise(Vector3f(30.0F * p.x(), 75.0F * p.y(), 22.0F * p.z()), 6U);
  // Thin where it begins: the hairline is no step.
  const float thin = 0.010F * std::clamp(1.0F + line / 0.035F, 0.0F, 1.0F);
  float d = std::max(volume.distance(p) + locks + thin, line);
  if (style_ == HairStyle::longer) {
    const float behind = p.x() - 0.012F + locks;
    d = smoothMin(d, std::max(fall.distance(p), behind), 0.02F);
  }
  return s * d;
}

}  // namespace pf::simulator
