// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/room_furniture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "simulator/random.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDoorwayMargin_m = 0.35;
constexpr double kCorner_m = 0.75;  // of a wall, left to the things along the next one
constexpr double kLow_m = 1.2;      // a picture hangs above what is lower

/// Before the wall, with its back at the foot of the wall, or hanging.
enum class Place { before, foot, high };

struct Thing {
  const char* kind;
  Vector3d size_m;
  Place place = Place::before;
};

/// What stands along the walls, what hangs there, and the group in the middle.
struct Style {
  std::vector<Thing> walls;
  std::vector<Thing> pictures;
  Thing middle;
  Thing seat;
  int seats;
  bool clutter;
};

const Thing kPoster{"poster", {0.006, 0.6, 0.85}, Place::high},
    kPhoto{"photo", {0.025, 0.7, 0.5}, Place::high},
    kBoard{"whiteboard", {0.025, 1.6, 1.0}, Place::high};
const Thing kShelf{"shelf", {0.3, 0.9, 1.8}}, kLowShelf{"shelf", {0.35, 1.2, 1.0}},
    kCabinet{"cabinet", {0.5, 0.8, 1.1}}, kCupboard{"cabinet", {0.55, 1.0, 2.0}},
    kStack{"stack", {0.45, 0.45, 1.1}}, kPlant{"plant", {0.5, 0.5, 1.3}},
    kBin{"bin", {0.3, 0.3, 0.35}}, kSofa{"sofa", {0.8, 1.8, 0.8}},
    kArmchair{"armchair", {0.75, 0.75, 0.95}}, kCoats{"coat_rack", {0.6, 0.6, 1.75}},
    kLamp{"lamp", {0.35, 0.35, 1.6}}, kBox{"box", {0.5, 0.6, 0.5}},
    kRadiator{"radiator", {0.1, 1.1, 0.55}, Place::foot}, kDesk{"desk", {0.7, 1.5, 0.73}},
    kBench{"table", {0.6, 1.6, 0.85}}, kCounter{"cabinet", {0.6, 1.2, 0.9}};

const std::map<std::string, Style>& styles() {
  static const std::map<std::string, Style> map = {
      {"office",
       {{kShelf, kCabinet, kDesk, kPlant, kCoats, kRadiator},
        {kPoster, kBoard},
        {"desk", {0.8, 1.6, 0.73}},
        {"office_chair", {0.52, 0.52, 0.95}},
        2,
        false}},
      {"meeting",
       {{kCabinet, kPlant, kRadiator, kBin, kLowShelf},
        {kBoard, kPhoto},
        {"table", {0.9, 2.0, 0.74}},
        {"chair", {0.46, 0.46, 0.86}},
        6,
        true}},
      {"kitchen",
       {{kCounter, kCounter, kCupboard, kBin, kRadiator},
        {kPhoto, kPoster},
        {"table", {0.8, 1.2, 0.75}},
        {"stool", {0.36, 0.36, 0.47}},
        4,
        true}},
      {"workshop",
       {{kBench, kStack, kCupboard, kLowShelf, kBox},
        {kPoster, kBoard},
        {"table", {0.9, 1.8, 0.85}},
        {"stool", {0.36, 0.36, 0.6}},
        2,
        true}},
      {"store",
       {{kShelf, kStack, kShelf, kBox, kCupboard},
        {kPoster},
        {"stack", {0.8, 1.0, 1.2}},
        {"box", {0.45, 0.45, 0.4}},
        3,
        false}},
      {"lounge",
       {{kSofa, kLamp, kPlant, kLowShelf, kRadiator, kCoats},
        {kPhoto, kPoster},
        {"table", {0.6, 1.0, 0.45}},
        {"armchair", {0.65, 0.65, 0.9}},
        2,
        true}},
      {"library",
       {{kShelf, kShelf, kShelf, kLowShelf, kArmchair, kPlant},
        {kPhoto},
        {"table", {0.8, 1.6, 0.74}},
        {"slat_chair", {0.46, 0.46, 0.92}},
        3,
        true}}};
  return map;
}

/// A wall with its low end, both in the world.
struct WallPlace {
  const char* name;
  Vector2d low, along;
  double length_m, yaw_rad;  ///< facing into the room
  double corner_m;

  Vector2d inwards() const { return {std::cos(yaw_rad), std::sin(yaw_rad)}; }
};

std::array<WallPlace, 4> wallPlacesOf(const RoomSpec& room) {
  const Vector2d low = room.origin_m, size = room.size_m.head<2>();
  const Vector2d x = Vector2d::UnitX(), y = Vector2d::UnitY();
  return {{{"south", low, x, size.x(), M_PI_2, 0.05},
           {"north", low + size.y() * y, x, size.x(), -M_PI_2, 0.05},
           {"west", low, y, size.y(), 0.0, kCorner_m},
           {"east", low + size.x() * x, y, size.y(), M_PI, kCorner_m}}};
}

class RoomFurnisher {
 public:
  explicit RoomFurnisher(const RoomSpec& room)
      : room_(room), style_(styles().at(room.furniture.style)), dice_(room.furniture.seed) {}

  std::vector<ObjectSpec> furnish() {
    for (const WallPlace& wall : wallPlacesOf(room_)) fillWall(wall);
    fillMiddle();
    return std::move(things_);
  }

 private:
  const Thing& anyOf(const std::vector<Thing>& things) {
    return things[static_cast<std::size_t>(dice_.below(static_cast<int>(things.size())))];
  }

  void add(const Thing& thing, const Vector2d& at, double z, double yaw_rad) {
    ObjectSpec spec;
    spec.kind = thing.kind;
    spec.at_m = {at.x(), at.y(), z};
    spec.yaw_rad = yaw_rad;
    spec.size_m = thing.size_m;
    spec.seed = dice_.next();
    things_.push_back(spec);
  }

  /// Where the wall is free again after the doorway that cuts into `from`..`to`; `from` where none
  /// does.
  double afterDoorway(const WallPlace& wall, double from, double to) const {
    for (const Doorway& doorway : room_.doorways) {
      const double half = 0.5 * doorway.width_m + kDoorwayMargin_m;
      const bool cuts = from < doorway.at_m + half && to > doorway.at_m - half;
      if (doorway.wall == wall.name && cuts) return doorway.at_m + half;
    }
    return from;
  }

  void fillWall(const WallPlace& wall) {
    double from = wall.corner_m + dice_.between(0.0, 0.4);
    for (;;) {
      Thing thing = anyOf(dice_.chance(0.8) ? style_.walls : style_.pictures);
      thing.size_m.y() *= dice_.between(0.9, 1.15);
      const double width = thing.size_m.y();
      const double free = afterDoorway(wall, from, from + width);
      if (free + width > wall.length_m - wall.corner_m) return;
      if (free > from) {
        from = free;
        continue;
      }
      place(wall, thing, from + 0.5 * width);
      from += width + dice_.between(0.05, 0.6);
    }
  }

  void place(const WallPlace& wall, const Thing& thing, double at_m) {
    const Vector2d foot = wall.low + at_m * wall.along;
    const bool stands = thing.place != Place::high;
    const double off = thing.place == Place::before ? 0.5 * thing.size_m.x() + 0.02 : 0.0;
    if (stands) add(thing, foot + off * wall.inwards(), 0.0, wall.yaw_rad);
    if (stands && (thing.size_m.z() > kLow_m || thing.size_m.y() < 0.7)) return;
    if (stands && !dice_.chance(0.6)) return;
    const Thing& picture = stands ? anyOf(style_.pictures) : thing;
    if (picture.size_m.y() <= thing.size_m.y()) {
      add(picture, foot, dice_.between(1.25, 1.4), wall.yaw_rad);
    }
  }

  void fillMiddle() {
    const Vector2d shift(dice_.between(-0.15, 0.15), dice_.between(-0.15, 0.15));
    const Vector2d at = room_.origin_m + 0.5 * room_.size_m.head<2>() + shift;
    const double yaw = (dice_.chance(0.5) ? M_PI_2 : 0.0) + dice_.between(-0.1, 0.1);
    const Vector3d size = style_.middle.size_m;
    add(style_.middle, at, 0.0, yaw);
    if (style_.clutter) {
      add({"clutter", {0.7 * size.x(), 0.8 * size.y(), 0.25}}, at, size.z(), yaw);
    }
    for (int i = 0; i < style_.seats; ++i) {
      const double side = i % 2 == 0 ? 1.0 : -1.0;
      const double row = (i / 2 + 1.0) / ((style_.seats + 1) / 2 + 1.0) - 0.5;
      const Vector2d out(side * std::cos(yaw), side * std::sin(yaw)), along(-out.y(), out.x());
      const double off = 0.5 * (size.x() + style_.seat.size_m.x()) + dice_.between(-0.08, 0.08);
      add(style_.seat, at + off * out + row * size.y() * along, 0.0,
          std::atan2(-out.y(), -out.x()) + dice_.between(-0.3, 0.3));
    }
  }

  const RoomSpec& room_;
  const Style& style_;
  Dice dice_;
  std::vector<ObjectSpec> things_;
};

}  // namespace

std::vector<std::string> furnitureStyles() {
  std::vector<std::string> names;
  for (const auto& entry : styles()) names.push_back(entry.first);
  return names;
}

std::vector<ObjectSpec> furnish(const RoomSpec& room) {
  if (room.furniture.style.empty()) return {};
  return RoomFurnisher(room).furnish();
}

}  // namespace pf::simulator
