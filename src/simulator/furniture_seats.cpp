// SPDX-License-Identifier: BSD-3-Clause
// Tables, chairs, sofas.
#include "simulator/furniture_parts.hpp"

namespace pf::simulator {

using Eigen::Vector3f;

namespace {

/// Four legs inside the corners of a part, up to `height`.
void addLegs(const Part& p, std::uint16_t material, float height, float radius) {
  for (const float sx : {-1.0F, 1.0F}) {
    for (const float sy : {-1.0F, 1.0F}) {
      const Vector3f foot(sx * (0.5F * p.size.x() - 2.0F * radius),
                          sy * (0.5F * p.size.y() - 2.0F * radius), 0.0F);
      addCylinder(p.world, p.at, material, foot, {radius, radius, height});
    }
  }
}

}  // namespace

void addTable(const Part& p) {
  const float top = 0.03F;
  p.box(p.material(), {0, 0, p.size.z() - 0.5F * top}, {p.size.x(), p.size.y(), top});
  const auto steel = p.material("metal", {0.55F, 0.55F, 0.58F});
  addLegs(p, steel, p.size.z() - top, 0.022F);
  p.box(steel, {0, 0, p.size.z() - top - 0.025F}, {p.size.x() - 0.1F, p.size.y() - 0.1F, 0.04F});
}

void addDesk(const Part& p) {
  addTable(p);
  const float z = p.size.z();
  const float shift = static_cast<float>(p.dice.between(-0.25, 0.25));
  addMonitor(p.moved({-0.18F, shift, z}, 0.0F, {0.2F, 0.52F, 0.42F}, "screen"));
  const auto keys = p.material("keys", Vector3f::Ones());
  p.box(keys, {0.16F, shift, z + 0.012F}, {0.15F, 0.44F, 0.022F});
  p.box(p.material("plastic", {0.06F, 0.06F, 0.07F}), {0.17F, shift + 0.32F, z + 0.015F},
        {0.10F, 0.06F, 0.03F});
  const float side = shift > 0 ? -1.0F : 1.0F;
  addClutter(p.moved({0.0F, side * 0.52F, z}, 0.0F, {0.5F, 0.4F, 0.2F}, "plastic"));
  p.box(p.material("panel", {0.8F, 0.8F, 0.8F}), {0, -side * (0.5F * p.size.y() - 0.26F), 0.29F},
        {p.size.x() - 0.16F, 0.4F, 0.58F});
}

void addChair(const Part& p) {
  const float seat = 0.45F;
  const auto wood = p.material();
  p.box(wood, {0, 0, seat - 0.02F}, {p.size.x(), p.size.y(), 0.035F});
  addLegs(p, wood, seat - 0.03F, 0.018F);
  const float x = -0.5F * p.size.x() + 0.015F;
  for (const float side : {-1.0F, 1.0F}) {
    p.box(wood, {x, side * (0.5F * p.size.y() - 0.025F), 0.5F * (seat + p.size.z())},
          {0.03F, 0.035F, p.size.z() - seat});
  }
  p.box(wood, {x, 0, p.size.z() - 0.09F}, {0.022F, p.size.y() - 0.02F, 0.17F});
  p.box(wood, {x, 0, seat + 0.14F}, {0.02F, p.size.y() - 0.06F, 0.06F});
}

void addOfficeChair(const Part& p) {
  const auto grey = static_cast<float>(p.dice.between(0.05, 0.4));
  const Vector3f color(grey, grey * static_cast<float>(p.dice.between(0.8, 1.1)),
                       grey * static_cast<float>(p.dice.between(0.8, 1.5)));
  const auto cloth = p.material("cloth", color);
  const auto black = p.material("plastic", {0.04F, 0.04F, 0.045F});
  p.box(cloth, {0, 0, 0.42F}, {p.size.x() - 0.02F, p.size.y() - 0.02F, 0.08F});
  p.box(cloth, {-0.5F * p.size.x() + 0.03F, 0, 0.73F}, {0.06F, p.size.y() - 0.08F, 0.44F});
  p.box(black, {-0.5F * p.size.x() + 0.01F, 0, 0.48F}, {0.04F, 0.06F, 0.2F});
  addCylinder(p.world, p.at, black, {0, 0, 0.08F}, {0.03F, 0.03F, 0.3F});
  for (int i = 0; i < 5; ++i) {
    const Placement arm = p.at * placed(0, 0, 0, 1.2566F * static_cast<float>(i));
    addBox(p.world, arm, black, {0.14F, 0, 0.07F}, {0.28F, 0.04F, 0.035F});
    addCylinder(p.world, arm, black, {0.26F, 0, 0.0F}, {0.028F, 0.028F, 0.055F});
  }
}

void addSofa(const Part& p) {
  const Vector3f color = p.tint.isOnes() ? Vector3f(0.35F, 0.16F, 0.13F) : p.tint;
  const auto cloth = p.material("cloth", color);
  const float d = p.size.x(), w = p.size.y(), h = p.size.z();
  p.box(cloth, {0, 0, 0.2F}, {d, w, 0.3F});
  p.box(cloth, {-0.5F * d + 0.11F, 0, 0.5F * (0.35F + h)}, {0.22F, w, h - 0.35F});
  for (const float side : {-1.0F, 1.0F}) {
    p.box(cloth, {0, side * (0.5F * w - 0.1F), 0.45F}, {d, 0.2F, 0.22F});
    p.box(cloth, {0.1F, side * 0.25F * (w - 0.4F), 0.4F}, {d - 0.24F, 0.5F * w - 0.22F, 0.12F});
  }
}

}  // namespace pf::simulator
