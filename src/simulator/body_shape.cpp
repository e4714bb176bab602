// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/body_shape.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace pf::simulator {

using Eigen::Vector3f;

float Blob::distance(const Vector3f& p) const {
  const Vector3f axis = b - a;
  const float length2 = axis.squaredNorm();
  const float t = length2 > 0.0F ? std::clamp((p - a).dot(axis) / length2, 0.0F, 1.0F) : 0.0F;
  const Vector3f out = p - a - t * axis;
  const float radius = radius_a + (radius_b - radius_a) * t;
  // The scaled distance grows too fast along squashed axes: bring it back by the gradient's length.
  const Vector3f scaled = out.cwiseQuotient(squash);
  const float norm = scaled.norm();
  if (norm < 1e-6F) return -radius * squash.minCoeff();
  const float gradient = scaled.cwiseQuotient(squash).norm() / norm;
  return (norm - radius) / std::max(gradient, 1e-3F);
}

float smoothMin(float a, float b, float k) {
  const float h = std::max(k - std::abs(a - b), 0.0F) / k;
  return std::min(a, b) - 0.25F * h * h * k;
}

namespace {

void scaleAll(std::vector<Blob>& blobs, float s) {
  for (Blob& blob : blobs) {
    blob.radius_a *= s;
    blob.radius_b *= s;
  }
}

void addTorso(std::vector<Blob>& out, const Rig& rig) {
  const float s = rig.scale();
  const float g = static_cast<float>(rig.build.stoutness);
  const bool f = rig.build.feminine;
  const float deep = 0.66F;
  const auto at = [&](float x, float y, float z) { return Vector3f(s * x, s * y, s * z); };
  const Vector3f flat(deep, 1, 1);
  const float hips = (f ? 0.172F : 0.160F) * g, waist = (f ? 0.128F : 0.148F) * g * g;
  const float chest = (f ? 0.145F : 0.165F) * (0.5F + 0.5F * g);
  out.push_back({Bone::pelvis, at(-0.01F, 0, 0.90F), at(0, 0, 0.99F), hips, hips * 0.95F, flat});
  out.push_back({Bone::spine, at(0, 0, 1.01F), at(0.005F, 0, 1.16F), waist, waist, flat});
  out.push_back(
      {Bone::chest, at(0.0F, 0, 1.20F), at(-0.005F, 0, 1.35F), chest * 0.96F, chest, flat});
  if (g > 1.1F) {
    const float belly = 0.13F * g;
    out.push_back({Bone::spine, at(0.05F, 0, 1.07F), at(0.04F, 0, 1.12F), belly, belly, flat});
  }
  const float yoke = rig.start[index(Bone::left_upper_arm)].y() / s - 0.035F;
  for (const float side : {1.0F, -1.0F}) {
    out.push_back(
        {Bone::chest, at(-0.015F, 0, 1.44F), at(-0.01F, side * yoke, 1.425F), 0.064F, 0.062F});
    out.push_back({Bone::chest, at(-0.02F, side * 0.02F, 1.49F), at(-0.015F, side * 0.12F, 1.45F),
                   0.05F, 0.05F});
    out.push_back({Bone::pelvis, at(-0.07F, side * 0.07F, 0.91F), at(-0.07F, side * 0.07F, 0.92F),
                   0.088F * g, 0.088F * g});
    if (f) {
      out.push_back({Bone::chest, at(0.065F, side * 0.065F, 1.28F), at(0.06F, side * 0.06F, 1.3F),
                     0.062F, 0.058F});
    } else {
      out.push_back({Bone::chest, at(0.05F, side * 0.06F, 1.31F), at(0.05F, side * 0.07F, 1.33F),
                     0.065F, 0.06F});
    }
  }
  out.push_back({Bone::neck, at(-0.012F, 0, 1.45F), at(0.0F, 0, 1.55F), 0.057F, 0.051F});
}

void addArm(std::vector<Blob>& out, const Rig& rig, const Outfit& outfit, float side) {
  const auto upper = side > 0 ? Bone::left_upper_arm : Bone::right_upper_arm;
  const auto fore = side > 0 ? Bone::left_forearm : Bone::right_forearm;
  const Vector3f a = rig.start[index(upper)], b = rig.start[index(fore)], c = rig.end[index(fore)];
  const float g = (rig.build.feminine ? 0.86F : 1.0F) * (0.5F + 0.5F * rig.build.stoutness);
  out.push_back({upper, a, b, 0.054F * g, 0.042F * g});
  out.push_back({upper, a, a + 0.3F * (b - a), 0.058F * g, 0.055F * g});
  out.push_back({fore, b, b + 0.4F * (c - b), 0.042F * g, 0.042F * g});
  out.push_back({fore, b, c, 0.042F * g, 0.029F * g});
  // Sleeves hang loose around the arm: wider than it, down to where they end.
  const float length = (c - a).norm(), elbow = (b - a).norm();
  const Vector3f d = (b - a).normalized();
  const float end = outfit.sleeve * length;
  out.push_back({upper, a, a + std::min(end, elbow) * d, 0.066F * g, 0.058F * g});
  if (end > elbow) out.push_back({fore, b, a + end * d, 0.056F * g, 0.042F * g});
}

void addLeg(std::vector<Blob>& out, const Rig& rig, const Outfit& outfit, float side) {
  const auto thigh = side > 0 ? Bone::left_thigh : Bone::right_thigh;
  const auto shin = side > 0 ? Bone::left_shin : Bone::right_shin;
  const auto foot = side > 0 ? Bone::left_foot : Bone::right_foot;
  const float s = rig.scale(), g = 0.4F + 0.6F * static_cast<float>(rig.build.stoutness);
  const Vector3f a = rig.start[index(thigh)], b = rig.start[index(shin)], c = rig.end[index(shin)];
  out.push_back({thigh, a, b, 0.086F * g, 0.058F * g});
  out.push_back({shin, b, c, 0.056F * g, 0.040F * g});
  out.push_back({shin, b + s * Vector3f(-0.02F, 0, -0.10F), b + s * Vector3f(-0.02F, 0, -0.2F),
                 0.056F * g, 0.045F * g});
  if (outfit.trouser_leg > 0.6F) {
    out.push_back({thigh, a, b, 0.094F * g, 0.074F * g});
    out.push_back({shin, b, c + s * Vector3f(0, 0, 0.0F), 0.072F * g, 0.062F * g});
  } else {
    out.push_back({thigh, a, b + s * Vector3f(0, 0, 0.04F), 0.096F * g, 0.085F * g});
  }
  const Vector3f heel = c + s * Vector3f(-0.035F, 0, -0.045F);
  const Vector3f toe = c + s * Vector3f(0.165F, side * 0.012F, -0.05F);
  out.push_back({foot, heel, toe, 0.045F, 0.036F, {1.0F, 1.0F, 0.85F}});
  out.push_back({foot, c, 0.5F * (c + toe) + s * Vector3f(0, 0, 0.01F), 0.046F, 0.042F});
}

/// A skirt or the lower part of a coat: wide legs that flow into each other.
void addHem(std::vector<Blob>& out, const Rig& rig, const Garments& wear) {
  const float g = static_cast<float>(rig.build.stoutness);
  const float hips = 0.125F * g, wide = hips + wear.flare_m;
  for (const float side : {1.0F, -1.0F}) {
    const auto thigh = side > 0 ? Bone::left_thigh : Bone::right_thigh;
    const auto shin = side > 0 ? Bone::left_shin : Bone::right_shin;
    const Vector3f a = rig.start[index(thigh)], b = rig.start[index(shin)],
                   c = rig.end[index(shin)];
    const float upper = std::min(1.0F, 2.0F * wear.hem),
                lower = std::max(0.0F, 2.0F * wear.hem - 1);
    const float knee = hips + (wide - hips) * upper / (upper + lower);
    out.push_back({thigh, a, a + upper * (b - a), hips, knee});
    if (lower > 0.0F) out.push_back({shin, b, b + lower * (c - b), knee, wide});
  }
}

/// Chest, waist and arms of what is there so far.
void thicken(float by_m, std::vector<Blob>& blobs) {
  static const std::set<Bone> covered = {Bone::spine,           Bone::chest,
                                         Bone::left_upper_arm,  Bone::left_forearm,
                                         Bone::right_upper_arm, Bone::right_forearm};
  for (Blob& blob : blobs) {
    if (covered.count(blob.bone) == 0) continue;
    blob.radius_a += by_m;
    blob.radius_b += by_m;
  }
}

void addWorn(std::vector<Blob>& out, const Rig& rig, const Garments& wear) {
  const float s = rig.scale();
  if (wear.rucksack) {
    const float back = -0.21F - wear.thickness_m;
    out.push_back({Bone::chest,
                   s * Vector3f(back, 0, 1.10F),
                   s * Vector3f(back, 0, 1.38F),
                   0.14F,
                   0.12F,
                   {0.7F, 1.0F, 1.0F}});
  }
  if (wear.bag) {
    out.push_back({Bone::pelvis,
                   s * Vector3f(-0.08F, 0.24F, 0.92F),
                   s * Vector3f(0.1F, 0.24F, 0.92F),
                   0.15F,
                   0.15F,
                   {1.0F, 0.5F, 1.0F}});
  }
}

}  // namespace

std::vector<Blob> bodyBlobs(const Rig& rig, const Outfit& outfit) {
  std::vector<Blob> blobs;
  addTorso(blobs, rig);
  for (const float side : {1.0F, -1.0F}) {
    addArm(blobs, rig, outfit, side);
    addLeg(blobs, rig, outfit, side);
  }
  if (outfit.garments.thickness_m > 0.0F) thicken(outfit.garments.thickness_m, blobs);
  if (outfit.garments.hem > 0.0F) addHem(blobs, rig, outfit.garments);
  addWorn(blobs, rig, outfit.garments);
  scaleAll(blobs, rig.scale());
  return blobs;
}

std::vector<Blob> handBlobs(const Rig& rig, float side) {
  const Bone hand = side > 0 ? Bone::left_hand : Bone::right_hand;
  const float s = rig.scale();
  const Vector3f w = rig.start[index(hand)], d = Rig::armDirection(side);
  const Vector3f across = Vector3f::UnitX();  // the thumb points forward
  const Vector3f palm = side * d.cross(across);
  std::vector<Blob> blobs;
  blobs.push_back({hand, w - s * 0.03F * d, w + s * 0.02F * d, 0.028F, 0.027F});
  for (int i = 0; i < 4; ++i) {
    const float offset = 0.027F - 0.018F * static_cast<float>(i);
    const float length = i == 3 ? 0.055F : i == 1 ? 0.078F : 0.070F;
    const Vector3f knuckle = w + s * (0.088F * d + offset * across);
    const Vector3f middle = knuckle + s * (0.55F * length * d + 0.012F * palm);
    const Vector3f tip = middle + s * (0.42F * length * d + 0.022F * palm);
    blobs.push_back(
        {hand, w + s * (0.012F * d + 0.5F * offset * across), knuckle, 0.015F, 0.0125F});
    blobs.push_back({hand, knuckle, middle, 0.0100F, 0.0090F});
    blobs.push_back({hand, middle, tip, 0.0090F, 0.0075F});
  }
  const Vector3f root = w + s * (0.025F * d + 0.02F * across + 0.006F * palm);
  const Vector3f joint = w + s * (0.062F * d + 0.048F * across + 0.016F * palm);
  blobs.push_back({hand, root, joint, 0.015F, 0.0115F});
  blobs.push_back({hand, joint, joint + s * (0.032F * d + 0.01F * across), 0.0110F, 0.0085F});
  scaleAll(blobs, s);
  return blobs;
}

}  // namespace pf::simulator
