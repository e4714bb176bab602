// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/person_room.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "simulator/furniture.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A kind with the least and the largest of its sizes.
struct Choice {
  const char* kind;
  Vector3d least, most;
};

const std::array<Choice, 8>& wallThings() {
  static const std::array<Choice, 8> things = {{{"shelf", {0.25, 0.6, 0.8}, {0.45, 1.4, 2.2}},
                                                {"cabinet", {0.35, 0.4, 0.6}, {0.65, 1.2, 2.1}},
                                                {"sofa", {0.75, 1.3, 0.65}, {1.0, 2.3, 0.95}},
                                                {"desk", {0.6, 1.2, 0.68}, {0.9, 1.8, 0.8}},
                                                {"stack", {0.3, 0.3, 0.6}, {0.7, 0.7, 1.9}},
                                                {"radiator", {0.08, 0.6, 0.4}, {0.14, 1.6, 0.7}},
                                                {"curtain", {0.08, 0.8, 1.8}, {0.2, 2.0, 2.3}},
                                                {"door", {0.045, 0.8, 2.0}, {0.05, 1.0, 2.1}}}};
  return things;
}

const std::array<Choice, 11>& looseThings() {
  static const std::array<Choice, 11> things = {
      {{"coat_rack", {0.5, 0.5, 1.5}, {0.7, 0.7, 1.9}},
       {"plant", {0.35, 0.35, 0.6}, {0.9, 0.9, 1.9}},
       {"lamp", {0.2, 0.2, 1.1}, {0.5, 0.5, 1.9}},
       {"slat_chair", {0.40, 0.40, 0.80}, {0.52, 0.52, 1.10}},
       {"armchair", {0.65, 0.65, 0.8}, {0.9, 0.9, 1.2}},
       {"office_chair", {0.48, 0.48, 0.9}, {0.6, 0.6, 1.1}},
       {"box", {0.15, 0.15, 0.15}, {0.8, 0.8, 1.1}},
       {"stack", {0.25, 0.25, 0.5}, {0.6, 0.6, 1.8}},
       {"bag", {0.12, 0.2, 0.25}, {0.4, 0.6, 0.8}},
       {"pillar", {0.15, 0.15, 2.2}, {0.5, 0.5, 2.6}},
       {"partition", {0.04, 0.7, 0.9}, {0.1, 1.8, 1.9}}}};
  return things;
}

/// Puts things into a room, apart from each other.
class Furnisher {
 public:
  Furnisher(PersonRoom& room, Dice& dice) : room_(room), dice_(dice) {}

  void furnish() {
    const double area = room_.size_m.x() * room_.size_m.y();
    const int tables = dice_.below(3 + static_cast<int>(area / 6.0));
    const int at_walls = 4 + dice_.below(9);
    const int loose = 2 + dice_.below(4 + static_cast<int>(area / 3.0));
    for (int i = 0; i < at_walls; ++i) addAtWall();
    for (int i = 0; i < tables; ++i) addTableGroup();
    for (int i = 0; i < loose; ++i) addLoose();
  }

 private:
  Vector3d sizeOf(const Choice& choice) {
    Vector3d size;
    for (int i = 0; i < 3; ++i) size[i] = dice_.between(choice.least[i], choice.most[i]);
    return size;
  }

  bool fits(const Vector2d& at, double radius) const {
    const Vector2d room = room_.size_m.head<2>();
    if ((at.array() < radius).any() || (at.array() > room.array() - radius).any()) return false;
    return std::none_of(taken_.begin(), taken_.end(), [&](const auto& circle) {
      return (circle.first - at).norm() < circle.second + radius;
    });
  }

  void add(const std::string& kind, const Vector3d& at, double yaw, const Vector3d& size) {
    ObjectSpec spec;
    spec.kind = kind;
    spec.at_m = at;
    spec.yaw_rad = yaw;
    spec.size_m = size;
    spec.seed = dice_.next();
    addObject(room_.world, spec);
    const Vector2d facing(std::cos(yaw), std::sin(yaw));
    if (kind == "sofa") addSofaSeats(at.head<2>(), yaw, size);
    const bool chair = kind == "slat_chair" || kind == "chair" || kind == "office_chair" ||
                       kind == "stool" || kind == "armchair";
    if (!chair) return;
    const double height = kind == "office_chair" ? 0.46 : kind == "armchair" ? 0.40 : 0.45;
    room_.seats.push_back({at.head<2>() + 0.05 * facing, yaw, height});
  }

  void addSofaSeats(const Vector2d& at, double yaw, const Vector3d& size) {
    const Vector2d facing(std::cos(yaw), std::sin(yaw)), left(-facing.y(), facing.x());
    for (const double side : {-0.25, 0.25}) {
      room_.seats.push_back({at + 0.1 * facing + side * (size.y() - 0.4) * left, yaw, 0.44});
    }
    if (size.y() > 1.7) room_.beds.push_back({at + 0.1 * facing, yaw + M_PI_2, 0.46});
  }

  void addAtWall() {
    const auto& choice = wallThings()[static_cast<std::size_t>(dice_.below(8))];
    const Vector3d size = sizeOf(choice);
    const int wall = dice_.below(4);
    const double yaw = wall * M_PI_2, x = room_.size_m.x(), y = room_.size_m.y();
    const double along = dice_.between(0.1, 0.9), off = 0.5 * size.x() + 0.02;
    const Vector2d places[4] = {
        {off, along * y}, {along * x, off}, {x - off, along * y}, {along * x, y - off}};
    const bool flat = size.x() < 0.21;
    const Vector2d at = places[wall] - (flat ? off : 0.0) * Vector2d(std::cos(yaw), std::sin(yaw));
    const double radius = 0.5 * size.y();
    const bool free = std::none_of(taken_.begin(), taken_.end(), [&](const auto& circle) {
      return (circle.first - at).norm() < circle.second + radius;
    });
    if (!free) return;
    taken_.emplace_back(at, radius);
    add(choice.kind, {at.x(), at.y(), 0.0}, yaw, size);
  }

  void addTableGroup() {
    const Vector3d size(dice_.between(0.6, 1.1), dice_.between(0.7, 2.2), dice_.between(0.45, 0.8));
    const double radius = 0.5 * size.head<2>().norm();
    const Vector2d at = anywhere();
    if (!fits(at, radius + 0.2)) return;
    taken_.emplace_back(at, radius);
    const double yaw = dice_.between(0.0, 2.0 * M_PI);
    add(dice_.chance(0.5) ? "desk" : "table", {at.x(), at.y(), 0.0}, yaw, size);
    if (dice_.chance(0.7)) {
      add("clutter", {at.x(), at.y(), size.z()}, yaw, {0.8 * size.x(), 0.8 * size.y(), 0.3});
    }
    const int chairs = dice_.below(5);
    for (int i = 0; i < chairs; ++i) addChairAt(at, yaw, size);
  }

  void addChairAt(const Vector2d& table, double yaw, const Vector3d& size) {
    static const std::array<const char*, 4> kinds = {"chair", "slat_chair", "office_chair",
                                                     "stool"};
    const double side = dice_.chance(0.5) ? 1.0 : -1.0;
    const Vector2d out(side * std::cos(yaw), side * std::sin(yaw)), along(-out.y(), out.x());
    const double shift = dice_.between(-0.4, 0.4) * size.y();
    const Vector2d at = table + (0.5 * size.x() + dice_.between(0.05, 0.35)) * out + shift * along;
    const double facing = std::atan2(-out.y(), -out.x()) + dice_.between(-0.4, 0.4);
    for (const Seat& seat : room_.seats) {
      if ((seat.at - at).norm() < 0.6) return;
    }
    const double wide = dice_.between(0.40, 0.50);
    add(kinds[static_cast<std::size_t>(dice_.below(4))], {at.x(), at.y(), 0.0}, facing,
        {wide, wide, dice_.between(0.82, 1.05)});
    taken_.emplace_back(at, 0.3);
  }

  void addLoose() {
    const auto& choice = looseThings()[static_cast<std::size_t>(dice_.below(11))];
    const Vector3d size = sizeOf(choice);
    const Vector2d at = anywhere();
    const double radius = 0.5 * size.head<2>().maxCoeff();
    const double yaw = dice_.between(0.0, 2.0 * M_PI);
    if (!fits(at, radius)) return;
    taken_.emplace_back(at, radius);
    add(choice.kind, {at.x(), at.y(), 0.0}, yaw, size);
  }

  Vector2d anywhere() {
    const double x = dice_.between(0.0, room_.size_m.x());
    return {x, dice_.between(0.0, room_.size_m.y())};
  }

  PersonRoom& room_;
  Dice& dice_;
  std::vector<std::pair<Vector2d, double>> taken_;
};

}  // namespace

PersonRoom drawRoom(Dice& dice) {
  static const std::array<const char*, 4> walls = {"south", "north", "west", "east"};
  PersonRoom room;
  room.world.plain = true;
  RoomSpec spec;
  for (int i = 0; i < 2; ++i) spec.size_m[i] = dice.between(2.8, i == 0 ? 10.0 : 8.0);
  spec.size_m.z() = dice.between(2.3, 3.4);
  spec.lamps_x = spec.lamps_y = 1;
  room.size_m = spec.size_m;
  for (std::size_t wall = 0; wall < walls.size(); ++wall) {
    const double length = spec.size_m[wall < 2 ? 0 : 1];
    const double at = dice.between(0.7, length - 0.7);
    if (dice.chance(0.25)) spec.doorways.push_back({walls[wall], at, 0.9, 2.05});
  }
  addRoom(room.world, spec, dice.next());
  Furnisher(room, dice).furnish();
  return room;
}

}  // namespace pf::simulator
