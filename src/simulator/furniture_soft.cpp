// SPDX-License-Identifier: BSD-3-Clause
// Slats, tilted backs and hanging cloth: what looks like a body to a depth camera.
#include <cmath>

#include "simulator/furniture_parts.hpp"

namespace pf::simulator {

using Eigen::Vector2f;
using Eigen::Vector3f;

namespace {

constexpr float kTurn_rad = 6.2831853F;

/// A round thing by its outline: `radius(t)` at height z = t * height, in the directions x and y.
/// `folds` m deep, `count` of them around.
struct Round {
  float height_m;
  std::function<Vector2f(float t)> radius;
  float folds_m = 0.0F;
  int count = 0;
};

void addRound(World& world, const Placement& at, std::uint16_t material, const Round& round) {
  const Vector2f middle = round.radius(0.5F);
  const Covering cover{material, kTurn_rad * middle.maxCoeff(), round.height_m,
                       round.count > 0 ? 0.04F : 0.06F};
  addSurface(world, at, cover, [&](float s, float t, Vector3f& p, Vector3f& n) {
    const float angle = kTurn_rad * s;
    const float fold = round.folds_m * std::sin(static_cast<float>(round.count) * angle);
    const Vector2f r = round.radius(t) + Vector2f::Constant(fold);
    p = {r.x() * std::cos(angle), r.y() * std::sin(angle), t * round.height_m};
    n = Vector3f(std::cos(angle), std::sin(angle), 0.0F);
  });
}

/// A coat: narrow at the collar, wide at the shoulders, wavy at the hem (z = 0).
void addCoat(World& world, const Placement& at, std::uint16_t material, Dice& dice) {
  const float length = random(dice, 0.6, 1.1), wide = random(dice, 0.14, 0.24);
  const float deep = random(dice, 0.06, 0.14), flare = random(dice, 0.8, 1.3);
  const auto radius = [&](float t) {
    const float closing = t > 0.85F ? std::max(0.15F, (1.0F - t) / 0.15F) : 1.0F;
    const float size = closing * (flare + (1.0F - flare) * t);
    return Vector2f(deep * size, wide * size);
  };
  addRound(world, at, material, {length, radius, random(dice, 0.0, 0.02), 5 + dice.below(5)});
}

/// Placement turned backwards by `lean` (rad) about the y axis.
Placement leaning(const Placement& at, float lean) {
  return at * Eigen::AngleAxisf(-lean, Vector3f::UnitY());
}

}  // namespace

void addStool(const Part& p) {
  const auto wood = p.material();
  const float r = 0.5F * p.size.x();
  addCylinder(p.world, p.at, wood, {0, 0, p.size.z() - 0.04F}, {r, r, 0.04F});
  for (int i = 0; i < 4; ++i) {
    const Placement leg = p.at * placed(0, 0, 0, 0.25F * kTurn_rad * static_cast<float>(i));
    addCylinder(p.world, leg, wood, {0.8F * r, 0, 0}, {0.018F, 0.018F, p.size.z() - 0.04F});
  }
}

void addSlatChair(const Part& p) {
  const float seat = 0.45F, w = p.size.y();
  const auto wood = p.material();
  p.box(wood, {0, 0, seat - 0.02F}, {p.size.x(), w, 0.035F});
  for (const float sx : {-1.0F, 1.0F}) {
    for (const float sy : {-1.0F, 1.0F}) {
      addCylinder(p.world, p.at, wood,
                  {sx * (0.5F * p.size.x() - 0.04F), sy * (0.5F * w - 0.04F), 0.0F},
                  {0.018F, 0.018F, seat - 0.03F});
    }
  }
  const float height = p.size.z() - seat;
  const Placement back =
      leaning(p.at * placed(-0.5F * p.size.x() + 0.02F, 0, seat), random(p.dice, 0.0, 0.35));
  const auto box = [&](const Vector3f& centre, const Vector3f& size) {
    addBox(p.world, back, wood, centre, size);
  };
  for (const float side : {-1.0F, 1.0F}) {
    box({0, side * 0.5F * (w - 0.04F), 0.5F * height}, {0.03F, 0.035F, height});
  }
  box({0, 0, height - 0.03F}, {0.025F, w, 0.07F});
  const int slats = 3 + p.dice.below(4);
  const bool upright = p.dice.chance(0.6);
  for (int i = 0; i < slats; ++i) {
    const float part = (static_cast<float>(i) + 0.5F) / static_cast<float>(slats);
    if (upright) {
      box({0, (part - 0.5F) * (w - 0.08F), 0.5F * height}, {0.015F, 0.035F, height - 0.05F});
    } else {
      box({0, 0, part * (height - 0.07F)}, {0.015F, w - 0.07F, 0.045F});
    }
  }
  if (p.dice.chance(0.25)) {
    addCoat(p.world, back * placed(-0.02F, 0, height - 0.75F), p.material("cloth", p.tint), p.dice);
  }
}

void addArmchair(const Part& p) {
  const auto cloth = p.material();
  const float d = p.size.x(), w = p.size.y();
  p.box(cloth, {0.05F, 0, 0.22F}, {d - 0.1F, w, 0.34F});
  const float height = p.size.z() - 0.38F;
  const Placement back =
      leaning(p.at * placed(-0.5F * d + 0.14F, 0, 0.38F), random(p.dice, 0.1, 0.5));
  addBox(p.world, back, cloth, {0, 0, 0.5F * height}, {0.14F, w - 0.04F, height});
  for (const float side : {-1.0F, 1.0F}) {
    p.box(cloth, {0.05F, side * (0.5F * w - 0.07F), 0.5F}, {d - 0.15F, 0.13F, 0.24F});
  }
  if (p.dice.chance(0.4)) {  // a cushion leans on the back
    const float r = random(p.dice, 0.16, 0.24);
    const auto radius = [r](float t) {
      const float size = std::sqrt(std::max(0.0F, 4.0F * t * (1.0F - t)));
      return Vector2f(0.3F * r * size, r * size);
    };
    addRound(p.world, back * placed(0.13F, random(p.dice, -0.1, 0.1), 0.02F), cloth,
             {2.0F * r, radius});
  }
}

void addCoatRack(const Part& p) {
  const auto wood = p.material("wood", p.tint);
  const float h = p.size.z();
  addCylinder(p.world, p.at, wood, {0, 0, 0}, {0.22F, 0.20F, 0.03F});
  addCylinder(p.world, p.at, wood, {0, 0, 0}, {0.022F, 0.02F, h});
  const int hooks = 3 + p.dice.below(3);
  for (int i = 0; i < hooks; ++i) {
    const float yaw = kTurn_rad * static_cast<float>(i) / static_cast<float>(hooks);
    const Placement hook = p.at * placed(0, 0, 0, yaw);
    addBox(p.world, hook, wood, {0.1F, 0, h - 0.08F}, {0.2F, 0.02F, 0.02F});
    if (!p.dice.chance(0.6)) continue;
    const Placement hung = hook * placed(0.16F, 0, 0, random(p.dice, -0.6, 0.6));
    const float low = h - 0.1F - random(p.dice, 0.75, 1.15);
    addCoat(p.world, hung * placed(0, 0, low), p.material("cloth", p.tint), p.dice);
  }
  if (!p.dice.chance(0.3)) return;  // a hat
  const auto radius = [](float t) {
    return Vector2f::Constant(0.1F * std::sqrt(std::max(0.02F, 1.0F - t * t)));
  };
  addRound(p.world, p.at * placed(0, 0, h - 0.02F), wood, {0.14F, radius});
}

void addLamp(const Part& p) {
  const auto metal = p.material("metal", p.tint);
  const float h = p.size.z(), r = 0.5F * p.size.x();
  addCylinder(p.world, p.at, metal, {0, 0, 0}, {0.13F, 0.13F, 0.025F});
  addCylinder(p.world, p.at, metal, {0, 0, 0}, {0.012F, 0.012F, h - 0.2F});
  addCylinder(p.world, p.at, p.material(), {0, 0, h - 0.28F}, {r, 0.6F * r, 0.28F});
}

void addCurtain(const Part& p) {
  const float w = p.size.y(), h = p.size.z(), deep = 0.4F * p.size.x();
  const float waves = 9.0F * w, phase = random(p.dice, 0.0, 6.0);
  const Covering cover{p.material(), w, h, 0.05F};
  addSurface(p.world, p.at, cover, [&](float s, float t, Vector3f& at, Vector3f& n) {
    const float angle = waves * kTurn_rad * 0.35F * s + phase;
    at = {0.05F + deep * (1.0F + std::sin(angle) * (1.0F - 0.5F * t)), w * (s - 0.5F), h * t};
    n = Vector3f(1.0F, -0.5F * std::cos(angle), 0.0F).normalized();
  });
}

void addBag(const Part& p) {
  const auto radius = [&](float t) {
    const float size = std::pow(std::max(0.0F, 4.0F * t * (1.0F - t)), 0.3F);
    return Vector2f(0.5F * p.size.x() * size, 0.5F * p.size.y() * size);
  };
  addRound(p.world, p.at, p.material(), {p.size.z(), radius, 0.008F, 4});
}

}  // namespace pf::simulator
