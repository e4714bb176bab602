// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/outfit.hpp"

#include <algorithm>
#include <cmath>

#include "simulator/random.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector3f;

constexpr float kHandIr = 0.55F;

Vector3f pick(Dice& dice, const std::vector<Vector3f>& colors) {
  return colors[static_cast<std::size_t>(dice.below(static_cast<int>(colors.size())))];
}

bool inEllipse(float x, float y, float half_x, float half_y) {
  return x * x / (half_x * half_x) + y * y / (half_y * half_y) < 1.0F;
}

}  // namespace

Outfit drawOutfit(std::uint32_t seed, bool feminine) {
  Dice dice(hash(seed, 501U));
  Outfit o;
  o.seed = seed;
  o.skin = pick(dice, {{0.58F, 0.36F, 0.26F},
                       {0.50F, 0.30F, 0.20F},
                       {0.36F, 0.20F, 0.13F},
                       {0.62F, 0.41F, 0.31F},
                       {0.20F, 0.11F, 0.07F},
                       {0.55F, 0.37F, 0.25F}});
  o.hair = pick(dice, {{0.018F, 0.015F, 0.014F},
                       {0.05F, 0.03F, 0.02F},
                       {0.12F, 0.07F, 0.035F},
                       {0.28F, 0.2F, 0.1F},
                       {0.2F, 0.2F, 0.2F},
                       {0.025F, 0.018F, 0.015F}});
  const int hair = dice.below(8);
  o.hair_style = feminine    ? (hair < 6 ? HairStyle::longer : HairStyle::full)
                 : hair == 0 ? HairStyle::bald
                 : hair < 5  ? HairStyle::cropped
                             : HairStyle::full;
  o.beard = !feminine && dice.chance(0.3);
  o.glasses = dice.chance(0.25);
  const std::vector<Vector3f> cloths = {
      {0.03F, 0.05F, 0.16F}, {0.45F, 0.05F, 0.05F}, {0.72F, 0.72F, 0.70F}, {0.02F, 0.02F, 0.025F},
      {0.08F, 0.22F, 0.10F}, {0.12F, 0.24F, 0.48F}, {0.55F, 0.40F, 0.12F}, {0.22F, 0.22F, 0.24F},
      {0.40F, 0.16F, 0.30F}, {0.30F, 0.42F, 0.50F}};
  o.shirt = pick(dice, cloths);
  do o.second = pick(dice, cloths);
  while ((o.second - o.shirt).norm() < 0.2F);
  const Pattern patterns[] = {Pattern::plain,  Pattern::plain, Pattern::stripes,
                              Pattern::checks, Pattern::logo,  Pattern::jacket};
  o.pattern = patterns[dice.below(6)];
  o.sleeve = o.pattern == Pattern::jacket || dice.chance(0.45) ? 0.97F : 0.27F;
  o.trousers = pick(dice, {{0.035F, 0.055F, 0.12F},
                           {0.02F, 0.02F, 0.022F},
                           {0.10F, 0.13F, 0.22F},
                           {0.30F, 0.23F, 0.14F},
                           {0.13F, 0.13F, 0.13F},
                           {0.06F, 0.05F, 0.04F}});
  o.trouser_leg = dice.chance(0.12) ? 0.5F : 1.0F;
  o.shoes = pick(
      dice,
      {{0.02F, 0.02F, 0.02F}, {0.10F, 0.05F, 0.025F}, {0.6F, 0.6F, 0.58F}, {0.2F, 0.2F, 0.22F}});
  return o;
}

Garments drawGarments(std::uint32_t seed) {
  Dice dice(hash(seed, 502U));
  Garments g;
  if (dice.chance(0.25)) {
    g.hem = static_cast<float>(dice.between(0.35, 0.95));
    g.flare_m = static_cast<float>(dice.between(0.0, 0.12));
  }
  if (dice.chance(0.3)) g.thickness_m = static_cast<float>(dice.between(0.01, 0.05));
  g.rucksack = dice.chance(0.12);
  g.bag = dice.chance(0.10);
  return g;
}

Appearance::Appearance(const Rig& rig, const Outfit& outfit) : rig_(rig), outfit_(outfit) {}

Appearance::Stuff Appearance::stuffAt(const SurfacePoint& point) const {
  if (point.part == BodyPart::burden) return Stuff::carton;
  if (point.part == BodyPart::hand) return Stuff::skin;
  if (point.part == BodyPart::head) return point.hair_tag < 0.0F ? Stuff::hair : Stuff::skin;
  const Vector3f p = point.rest / rig_.scale();
  const float side = p.y() > 0.0F ? 1.0F : -1.0F;
  const Bone arm = side > 0 ? Bone::left_upper_arm : Bone::right_upper_arm;
  const Vector3f out = point.rest - rig_.start[index(arm)];
  const Vector3f d = Rig::armDirection(side);
  const float along = out.dot(d), beside = (out - along * d).norm();
  if (along > 0.05F && beside < 0.10F && std::abs(p.y()) > 0.19F) {
    const float length = (rig_.end[index(arm) + 1] - rig_.start[index(arm)]).norm();
    return along < outfit_.sleeve * length + 0.012F ? Stuff::shirt : Stuff::skin;
  }
  if (p.z() < 0.060F || (p.z() < 0.105F && p.x() > 0.035F)) return Stuff::shoe;
  const float hem = 0.93F + 0.06F * uniform(hash(outfit_.seed, 9U));
  if (p.z() < hem) {
    if (p.z() < 0.92F - 0.835F * outfit_.trouser_leg) return Stuff::skin;
    return p.z() > hem - 0.028F && hem > 0.96F ? Stuff::belt : Stuff::trousers;
  }
  const float neckline = 1.478F - 0.25F * std::max(0.0F, p.x());
  const float radius = std::hypot(p.x() + 0.01F, p.y());
  return p.z() > neckline && radius < 0.085F ? Stuff::skin : Stuff::shirt;
}

Vector3f Appearance::shirtColor(const SurfacePoint& point) const {
  const Vector3f p = point.rest / rig_.scale();
  const bool front = point.normal.x() > 0.0F && std::abs(p.y()) < 0.2F;
  const float sideways = std::abs(point.normal.x()) > 0.5F ? p.y() : p.x();
  const auto wave = [](float x) { return x - std::floor(x); };
  switch (outfit_.pattern) {
    case Pattern::stripes:
      return wave(p.z() / 0.055F) < 0.4F ? outfit_.second : outfit_.shirt;
    case Pattern::checks: {
      const float part = (wave(p.z() / 0.06F) < 0.4F ? 0.5F : 0.0F) +
                         (wave(sideways / 0.06F) < 0.4F ? 0.5F : 0.0F);
      return outfit_.shirt + part * (outfit_.second - outfit_.shirt);
    }
    case Pattern::logo: {
      if (!front || !inEllipse(p.y(), p.z() - 1.30F, 0.085F, 0.06F)) return outfit_.shirt;
      const float print = latticeNoise(Vector3f(p.y() * 70.0F, p.z() * 70.0F, 0.5F), outfit_.seed);
      return print > -0.1F ? outfit_.second : outfit_.shirt;
    }
    case Pattern::jacket: {
      const float open = 0.018F + 0.30F * std::max(0.0F, p.z() - 1.22F);
      if (!front) return outfit_.shirt;
      if (std::abs(p.y()) < open) return outfit_.second;
      return std::abs(p.y()) < open + 0.008F ? Vector3f(0.4F * outfit_.shirt) : outfit_.shirt;
    }
    default:
      return outfit_.shirt;
  }
}

Vector3f Appearance::color(const SurfacePoint& point) const {
  const Vector3f& p = point.rest;
  const auto grain = [&](float cells, float height) {
    return 1.0F + height * latticeNoise(cells * p, outfit_.seed);
  };
  switch (stuffAt(point)) {
    case Stuff::skin:
      if (point.part == BodyPart::head) return faceColor(p / rig_.scale());
      return point.part == BodyPart::hand ? handColor(p)
                                          : Vector3f(outfit_.skin * grain(60, 0.06F));
    case Stuff::hair: {
      const Vector3f strands(p.x() * 60.0F, p.y() * 420.0F, p.z() * 50.0F);
      return outfit_.hair * (1.0F + 0.55F * latticeNoise(strands, outfit_.seed));
    }
    case Stuff::shirt:
      return shirtColor(point) * grain(90, 0.07F) * grain(14, 0.06F);
    case Stuff::trousers: {
      // A side seam and pockets.
      const bool seam = std::abs(point.normal.x()) < 0.09F && std::abs(point.normal.y()) > 0.9F;
      return outfit_.trousers * grain(120, 0.12F) * grain(9, 0.18F) * (seam ? 0.75F : 1.0F);
    }
    case Stuff::carton: {
      // Adhesive tape along the middle.
      const bool tape = std::abs(p.y()) < 0.025F && std::abs(point.normal.y()) < 0.7F;
      return Vector3f(0.42F, 0.25F, 0.12F) * grain(40, 0.08F) * (tape ? 1.3F : 1.0F);
    }
    case Stuff::belt:
      return {0.03F, 0.02F, 0.015F};
    default:
      return p.z() < 0.022F * rig_.scale() ? Vector3f(0.10F, 0.10F, 0.10F)
                                           : Vector3f(outfit_.shoes * grain(50, 0.1F));
  }
}

Vector3f Appearance::handColor(const Vector3f& p) const {
  return outfit_.skin.cwiseProduct(Vector3f(1.05F, 0.95F, 0.93F)) *
         (1.0F + 0.10F * latticeNoise(90.0F * p, outfit_.seed));
}

Vector3f Appearance::faceColor(const Vector3f& p) const {
  Vector3f skin = outfit_.skin * (1.0F + 0.05F * latticeNoise(70.0F * p, outfit_.seed));
  const float y = std::abs(p.y());
  if (p.x() < 0.03F) return skin;
  const float ey = y - 0.0315F, ez = p.z() - 1.6365F;
  if (inEllipse(ey, ez, 0.0145F, 0.0060F) && p.x() > 0.06F) {
    const float iris = std::hypot(ey, ez);
    if (iris < 0.0026F) return Vector3f::Constant(0.01F);
    if (iris < 0.0062F) return 0.6F * outfit_.hair + Vector3f(0.03F, 0.03F, 0.035F);
    return {0.62F, 0.60F, 0.58F};
  }
  if (inEllipse(ey, ez - 0.0035F, 0.0165F, 0.0070F)) return 0.42F * skin;  // lashes
  if (inEllipse(ey - 0.002F, ez - 0.0190F - 0.12F * ey, 0.0215F, 0.0042F)) {
    return 0.35F * skin + 0.5F * outfit_.hair;  // brow
  }
  if (outfit_.glasses) {
    const float ring = std::max(std::abs(ey) / 0.024F, std::abs(ez) / 0.018F);
    if (ring > 0.86F && ring < 1.06F) return Vector3f::Constant(0.02F);
    if (y < 0.01F && std::abs(ez) < 0.003F) return Vector3f::Constant(0.02F);
  }
  if (inEllipse(y - 0.009F, p.z() - 1.5995F, 0.0048F, 0.0032F)) return 0.22F * skin;  // nostrils
  if (std::abs(p.z() - 1.5680F) < 0.0016F && y < 0.0235F) return 0.25F * skin;
  if (inEllipse(y, p.z() - 1.5675F, 0.0245F, 0.0095F)) {
    return skin.cwiseProduct(Vector3f(0.86F, 0.60F, 0.60F));
  }
  if (outfit_.beard && p.z() < 1.589F - 0.6F * (0.05F - std::min(0.05F, y))) {
    return 0.30F * skin + 0.6F * outfit_.hair;
  }
  if (inEllipse(y - 0.045F, p.z() - 1.602F, 0.025F, 0.02F)) {
    return skin.cwiseProduct(Vector3f(1.06F, 0.92F, 0.92F));
  }
  return skin;
}

float Appearance::infrared(const SurfacePoint& point) const {
  switch (stuffAt(point)) {
    case Stuff::hair:
      return 0.08F + 0.5F * outfit_.hair.maxCoeff();
    case Stuff::skin:
      return kHandIr;
    case Stuff::shoe:
      return 0.15F + 0.4F * outfit_.shoes.maxCoeff();
    default:
      return 0.55F;  // dyes are bright in the near infrared
  }
}

}  // namespace pf::simulator
