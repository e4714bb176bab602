// SPDX-License-Identifier: BSD-3-Clause
// What stands around: shelves, boxes, plants, monitors, clutter.
#include <algorithm>
#include <cmath>

#include "simulator/furniture_parts.hpp"

namespace pf::simulator {

using Eigen::Vector3f;

namespace {

Vector3f brightColor(Dice& dice) {
  const Vector3f c(static_cast<float>(dice.between(0.05, 0.8)),
                   static_cast<float>(dice.between(0.05, 0.8)),
                   static_cast<float>(dice.between(0.05, 0.8)));
  return Vector3f::Constant(0.5F * c.mean()) + 0.5F * c;
}

}  // namespace

void addShelf(const Part& p) {
  const auto board = p.material();
  const float d = p.size.x(), w = p.size.y(), h = p.size.z();
  for (const float side : {-1.0F, 1.0F}) {
    p.box(board, {0, side * 0.5F * (w - 0.02F), 0.5F * h}, {d, 0.02F, h});
  }
  p.box(board, {-0.5F * d + 0.005F, 0, 0.5F * h}, {0.01F, w - 0.04F, h});
  const int floors = std::max(1, static_cast<int>(h / 0.36F));
  const float step = (h - 0.04F) / static_cast<float>(floors);
  for (int i = 0; i <= floors; ++i) {
    const float z = 0.02F + step * static_cast<float>(i);
    p.box(board, {0, 0, z}, {d - 0.01F, w - 0.04F, 0.022F});
    if (i == floors) break;
    const float width = random(p.dice, 0.45, 0.95) * (w - 0.06F);
    const float height = std::min(0.24F, step - 0.06F);
    const auto books = p.world.material("books", p.dice.next() % 5U);
    p.box(books,
          {random(p.dice, -0.02, 0.02), -0.5F * (w - 0.05F) + 0.5F * width,
           z + 0.011F + 0.5F * height},
          {d - 0.1F, width, height});
    if (width < 0.7F * w) {
      addClutter(p.moved({0, 0.5F * (w - 0.05F) - 0.11F, z + 0.011F}, 0, {d - 0.1F, 0.2F, 0.2F},
                         "plastic"));
    }
  }
}

void addStairs(const Part& p) {
  // The uppermost step is the floor that they lead to.
  const auto material = p.material();
  const int steps = std::max(2, static_cast<int>(std::lround(p.size.z() / 0.17F)));
  const float tread = p.size.x() / static_cast<float>(steps - 1);
  for (int i = 1; i < steps; ++i) {
    const float height = p.size.z() * static_cast<float>(steps - i) / static_cast<float>(steps);
    const float x = -0.5F * p.size.x() + (static_cast<float>(i) - 0.5F) * tread;
    p.box(material, {x, 0, 0.5F * height}, {tread, p.size.y(), height});
  }
}

void addCabinet(const Part& p) {
  const auto front = p.material();
  const auto body = p.material("plastic", p.tint.cwiseProduct(Vector3f(0.85F, 0.85F, 0.83F)));
  p.box(body, {-0.01F, 0, 0.5F * p.size.z()}, {p.size.x() - 0.02F, p.size.y(), p.size.z()});
  p.box(front, {0.5F * p.size.x() - 0.005F, 0, 0.5F * p.size.z()},
        {0.01F, p.size.y() - 0.01F, p.size.z() - 0.02F});
}

void addPlainBox(const Part& p) { p.box(p.material(), {0, 0, 0.5F * p.size.z()}, p.size); }

void addStack(const Part& p) {
  float z = 0.0F;
  while (z < p.size.z() - 0.15F) {
    const float shrink = random(p.dice, 0.75, 1.0);
    const Vector3f size(p.size.x() * shrink, p.size.y() * shrink,
                        std::min(random(p.dice, 0.2, 0.4), p.size.z() - z));
    addPlainBox(p.moved({random(p.dice, -0.03, 0.03), random(p.dice, -0.03, 0.03), z},
                        random(p.dice, -0.25, 0.25), size, p.texture));
    z += size.z();
  }
}

void addPlant(const Part& p) {
  const auto pot = p.material("plastic", {0.45F, 0.2F, 0.12F});
  const auto leaf = p.material();
  addCylinder(p.world, p.at, pot, {0, 0, 0}, {0.12F, 0.16F, 0.3F});
  addCylinder(p.world, p.at, p.material("wood", {0.5F, 0.45F, 0.35F}), {0, 0, 0.3F},
              {0.018F, 0.012F, 0.5F * p.size.z()});
  for (int i = 0; i < 34; ++i) {
    const float yaw = 2.39996F * static_cast<float>(i);
    const float rise = 0.38F + 0.6F * random(p.dice, 0.0, 1.0);
    const float reach = 0.5F * p.size.x() * random(p.dice, 0.5, 1.1);
    const float droop = random(p.dice, -0.12, 0.25);
    const Placement stem = p.at * placed(0, 0, rise * p.size.z(), yaw);
    const float width = random(p.dice, 0.05, 0.09);
    const Covering cover{leaf, reach, width, 0.05F};
    addSurface(p.world, stem, cover, [&](float s, float t, Vector3f& at, Vector3f& n) {
      const float half = width * std::sin(3.1F * (0.04F + 0.93F * s));
      at = {0.03F + reach * s, half * (2.0F * t - 1.0F), droop * s - 0.2F * s * s};
      n = Vector3f(-droop + 0.4F * s, 0.5F * (2.0F * t - 1.0F), 1.0F).normalized();
    });
  }
}

void addBin(const Part& p) {
  addCylinder(p.world, p.at, p.material("plastic", {0.12F, 0.13F, 0.15F}), {0, 0, 0},
              {0.4F * p.size.x(), 0.5F * p.size.x(), p.size.z()});
}

void addTrolley(const Part& p) {
  const auto steel = p.material();
  const auto rubber = p.material("plastic", {0.05F, 0.05F, 0.05F});
  const float d = p.size.x(), w = p.size.y(), h = p.size.z();
  for (const float sx : {-1.0F, 1.0F}) {
    for (const float sy : {-1.0F, 1.0F}) {
      const Vector3f foot(sx * (0.5F * d - 0.03F), sy * (0.5F * w - 0.03F), 0.0F);
      addCylinder(p.world, p.at, rubber, foot, {0.03F, 0.03F, 0.07F});
      addCylinder(p.world, p.at, steel, foot + Vector3f(0, 0, 0.07F),
                  {0.014F, 0.014F, h - (sx < 0 ? 0.07F : 0.2F)});
    }
  }
  p.box(steel, {-0.5F * d + 0.03F, 0, h}, {0.03F, w - 0.03F, 0.03F});
  for (const float z : {0.16F, h - 0.25F}) {
    p.box(p.material("board", p.tint), {0, 0, z}, {d, w, 0.03F});
    const float height = random(p.dice, 0.12, 0.3);
    p.box(p.material("carton", Vector3f::Ones()),
          {random(p.dice, -0.15, 0.15), random(p.dice, -0.05, 0.05), z + 0.015F + 0.5F * height},
          {0.34F, 0.3F, height});
  }
}

void addPillar(const Part& p) { p.box(p.material(), {0, 0, 0.5F * p.size.z()}, p.size); }

void addMonitor(const Part& p) {
  const auto black = p.material("plastic", {0.03F, 0.03F, 0.035F});
  const float w = p.size.y(), h = p.size.z();
  p.box(black, {0, 0, 0.01F}, {0.18F, 0.24F, 0.018F});
  p.box(black, {-0.03F, 0, 0.12F}, {0.03F, 0.06F, 0.22F});
  p.box(black, {0, 0, h - 0.16F}, {0.035F, w, 0.32F});
  const auto picture = p.world.material("screen", p.dice.next() % 3U);
  addRectangle(p.world, p.at, picture,
               {Vector3f(0.0185F, -0.5F * w + 0.015F, h - 0.305F), Vector3f(0, w - 0.03F, 0),
                Vector3f(0, 0, 0.29F)});
}

void addClutter(const Part& p) {
  const int count = std::max(2, static_cast<int>(p.size.x() * p.size.y() * 28.0F));
  for (int i = 0; i < count; ++i) {
    const Vector3f at((random(p.dice, -0.5, 0.5)) * (p.size.x() - 0.12F),
                      (random(p.dice, -0.5, 0.5)) * (p.size.y() - 0.12F), 0.0F);
    const float yaw = random(p.dice, -0.6, 0.6);
    const float h = std::min(random(p.dice, 0.08, 0.24), p.size.z());
    const Part item = p.moved(at, yaw, {0.1F, 0.1F, h}, "plastic");
    switch (p.dice.below(5)) {
      case 0:  // bottle or mug
        addCylinder(p.world, item.at, p.material("plastic", brightColor(p.dice)), {0, 0, 0},
                    {0.035F, 0.03F, h});
        break;
      case 1:  // a few books lying
        item.box(p.world.material("books", p.dice.next() % 5U), {0, 0, 0.03F},
                 {0.16F, 0.22F, 0.06F});
        break;
      case 2:
        item.box(p.material("paper", Vector3f::Ones()), {0, 0, 0.004F}, {0.21F, 0.297F, 0.008F});
        break;
      case 3:
        item.box(p.material("carton", Vector3f::Ones()), {0, 0, 0.4F * h},
                 {0.14F, 0.12F, 0.8F * h});
        break;
      default:
        item.box(p.material("plastic", brightColor(p.dice)), {0, 0, 0.5F * h}, {0.09F, 0.07F, h});
    }
  }
}

void addHanging(const Part& p) {
  // The picture alone on the front; frame and rims plain.
  const auto rim = p.material("plastic", {0.5F, 0.5F, 0.48F});
  p.box(rim, {0.5F * p.size.x(), 0, 0.5F * p.size.z()}, p.size);
  addRectangle(p.world, p.at, p.material(),
               {Vector3f(p.size.x() + 0.001F, -0.5F * p.size.y(), 0), Vector3f(0, p.size.y(), 0),
                Vector3f(0, 0, p.size.z())});
  if (p.texture == "door") {
    const auto steel = p.material("metal", {0.8F, 0.8F, 0.8F});
    p.box(steel, {p.size.x() + 0.04F, 0.4F * p.size.y() - 0.04F, 1.03F}, {0.02F, 0.12F, 0.02F});
  }
}

void addWindow(const Part& p) {
  addHanging(p);
  const float x = p.size.x() + 0.02F;
  p.world.lights.push_back(
      {p.at * Vector3f(x, 0, 0.5F * p.size.z()), p.at.linear() * Vector3f(0, 0.5F * p.size.y(), 0),
       p.at.linear() * Vector3f(0, 0, 0.5F * p.size.z()), Vector3f(1.9F, 2.1F, 2.4F)});
  p.box(p.material("plastic", {0.9F, 0.9F, 0.88F}), {0.07F, 0, -0.02F},
        {0.16F, p.size.y() + 0.1F, 0.03F});
}

void addRadiator(const Part& p) {
  const auto steel = p.material("plastic", {1.1F, 1.1F, 1.08F});
  const int ribs = static_cast<int>(p.size.y() / 0.06F);
  for (int i = 0; i < ribs; ++i) {
    const float y = -0.5F * p.size.y() + 0.06F * (static_cast<float>(i) + 0.5F);
    p.box(steel, {0.5F * p.size.x() + 0.03F, y, 0.12F + 0.5F * p.size.z()},
          {p.size.x(), 0.042F, p.size.z()});
  }
}

}  // namespace pf::simulator
