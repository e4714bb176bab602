// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "posefusion/core/error.hpp"
#include "simulator/furniture.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector3f;

constexpr float kWallThickness_m = 0.12F;
constexpr float kWallCell_m = 0.14F;

/// A wall in its own frame: x along it, y into the room, z up.
struct Wall {
  const char* name;
  Placement at;
  float length;
};

std::array<Wall, 4> wallsOf(const RoomSpec& spec) {
  const auto x0 = static_cast<float>(spec.origin_m.x()), y0 = static_cast<float>(spec.origin_m.y());
  const auto w = static_cast<float>(spec.size_m.x()), d = static_cast<float>(spec.size_m.y());
  constexpr float kQuarter = 1.57079633F;
  // North and east run against their axis: placed by their high corner.
  return {{{"south", placed(x0, y0, 0, 0), w},
           {"north", placed(x0 + w, y0 + d, 0, 2 * kQuarter), w},
           {"west", placed(x0, y0 + d, 0, -kQuarter), d},
           {"east", placed(x0 + w, y0, 0, kQuarter), d}}};
}

struct Surfaces {
  std::uint16_t wall;
  std::uint16_t skirting;
};

/// One upright piece of wall from x = a to b and z = low to high.
void addPiece(World& world, const Wall& wall, const Surfaces& s, const Eigen::Vector4f& abzz) {
  const float a = abzz[0], b = abzz[1], low = abzz[2], high = abzz[3];
  if (b - a < 1e-3F || high - low < 1e-3F) return;
  // Front towards the room: from b to a, then up.
  addRectangle(world, wall.at, s.wall,
               {Vector3f(b, 0, low), Vector3f(a - b, 0, 0), Vector3f(0, 0, high - low)},
               kWallCell_m);
  if (low > 0.0F) return;
  addBox(world, wall.at, s.skirting, {0.5F * (a + b), 0.006F, 0.04F}, {b - a, 0.012F, 0.08F});
}

/// Cheeks and lintel of an opening, through the thickness of the wall.
void addReveal(World& world, const Wall& wall, const Surfaces& s, const Eigen::Vector3f& abh) {
  const float t = kWallThickness_m, h = abh.z();
  addRectangle(world, wall.at, s.skirting,
               {Vector3f(abh.x(), -t, 0), Vector3f(0, t, 0), Vector3f(0, 0, h)}, kWallCell_m);
  addRectangle(world, wall.at, s.skirting,
               {Vector3f(abh.y(), 0, 0), Vector3f(0, -t, 0), Vector3f(0, 0, h)}, kWallCell_m);
  addRectangle(world, wall.at, s.skirting,
               {Vector3f(abh.x(), 0, h), Vector3f(0, -t, 0), Vector3f(abh.y() - abh.x(), 0, 0)},
               kWallCell_m);
  addRectangle(world, wall.at, s.skirting,
               {Vector3f(abh.x(), -t, 0), Vector3f(abh.y() - abh.x(), 0, 0), Vector3f(0, t, 0)},
               kWallCell_m);
}

/// People may walk through the middle of the opening.
void addPassage(World& world, const Wall& wall, float a, float b) {
  const Vector3f middle = wall.at * Vector3f(0.5F * (a + b), -0.5F * kWallThickness_m, 0.0F);
  const Vector3f along = wall.at.linear() * Vector3f::UnitX();
  world.passages.push_back({middle.head<2>().cast<double>(),
                            {std::max(0.1, 0.5 * (b - a) - 0.28), 0.5},
                            std::atan2(along.y(), along.x())});
}

void addWall(World& world, const Wall& wall, const RoomSpec& spec, const Surfaces& s) {
  const auto height = static_cast<float>(spec.size_m.z());
  std::vector<Doorway> doorways;
  for (Doorway doorway : spec.doorways) {
    if (doorway.wall != wall.name) continue;
    const bool reversed = doorway.wall == "north" || doorway.wall == "west";
    if (reversed) doorway.at_m = wall.length - doorway.at_m;
    doorways.push_back(doorway);
  }
  std::sort(doorways.begin(), doorways.end(),
            [](const Doorway& a, const Doorway& b) { return a.at_m < b.at_m; });
  float from = 0.0F;
  for (const Doorway& doorway : doorways) {
    const auto a = static_cast<float>(doorway.at_m - 0.5 * doorway.width_m);
    const auto b = static_cast<float>(doorway.at_m + 0.5 * doorway.width_m);
    const auto h = static_cast<float>(doorway.height_m);
    if (a < from || b > wall.length || h >= height) {
      throw InputError("doorways: the one in the " + doorway.wall +
                       " wall does not fit, expected it within the wall, lower than the room, "
                       "apart from others");
    }
    addPiece(world, wall, s, {from, a, 0.0F, height});
    addPiece(world, wall, s, {a, b, h, height});
    addReveal(world, wall, s, {a, b, h});
    addPassage(world, wall, a, b);
    from = b;
  }
  addPiece(world, wall, s, {from, wall.length, 0.0F, height});
}

void addLamps(World& world, const RoomSpec& spec) {
  Material glow;
  glow.texture = world.materials[world.material("blank", 0)].texture;
  glow.emission = Vector3f::Constant(static_cast<float>(spec.lamp_radiance));
  glow.infrared = 0.05F;
  world.materials.push_back(glow);
  const auto material = static_cast<std::uint16_t>(world.materials.size() - 1);
  const auto z = static_cast<float>(spec.size_m.z()) - 0.03F;
  const Vector3f half_u(0.6F, 0, 0), half_v(0, -0.15F, 0);  // u x v points down
  for (int i = 0; i < spec.lamps_x * spec.lamps_y; ++i) {
    const double fx = (i % spec.lamps_x + 0.5) / spec.lamps_x;
    const double fy = (i / spec.lamps_x + 0.5) / spec.lamps_y;
    const Vector3f centre(static_cast<float>(spec.origin_m.x() + fx * spec.size_m.x()),
                          static_cast<float>(spec.origin_m.y() + fy * spec.size_m.y()), z);
    addRectangle(world, Placement::Identity(), material,
                 {centre - half_u - half_v, 2 * half_u, 2 * half_v});
    const Vector3f warm(1.0F, 0.97F, 0.90F);
    world.lights.push_back({centre - Vector3f(0, 0, 0.005F), half_u, half_v,
                            static_cast<float>(spec.lamp_radiance) * warm});
  }
}

}  // namespace

void addRoom(World& world, const RoomSpec& spec, std::uint32_t seed) {
  const Vector3f low(static_cast<float>(spec.origin_m.x()), static_cast<float>(spec.origin_m.y()),
                     0.0F);
  const Vector3f size = spec.size_m.cast<float>();
  const Vector3f x(size.x(), 0, 0), y(0, size.y(), 0);
  const Placement here = Placement::Identity();
  const auto floor = world.material(spec.floor, seed, spec.floor_color.cast<float>());
  const auto ceiling = world.material(spec.ceiling, seed + 1U);
  addRectangle(world, here, floor, {low, x, y}, kWallCell_m);
  addRectangle(world, here, ceiling, {low + Vector3f(0, size.y(), size.z()), x, -y}, kWallCell_m);
  const Surfaces surfaces{world.material(spec.walls, seed + 2U, spec.wall_color.cast<float>()),
                          world.material("plastic", seed + 3U, Vector3f(0.8F, 0.78F, 0.74F))};
  for (const Wall& wall : wallsOf(spec)) addWall(world, wall, spec, surfaces);
  addLamps(world, spec);
  world.rooms.emplace_back(low.cast<double>(), (low + size).cast<double>());
}

}  // namespace pf::simulator
