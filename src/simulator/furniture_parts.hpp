// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "simulator/random.hpp"
#include "simulator/world.hpp"

namespace pf::simulator {

/// What the maker of one piece is given: where, how large, of what, and dice for variations.
struct Part {
  World& world;
  Placement at;
  Eigen::Vector3f size;
  std::string texture;
  Eigen::Vector3f tint;
  Dice& dice;

  std::uint16_t material() const { return world.material(texture, dice.next() % 4U, tint); }
  std::uint16_t material(const std::string& kind, const Eigen::Vector3f& color) const {
    return world.material(kind, dice.next() % 4U, color);
  }
  void box(std::uint16_t material, const Eigen::Vector3f& centre,
           const Eigen::Vector3f& box_size) const {
    addBox(world, at, material, centre, box_size);
  }
  /// The same at another place of this part's frame.
  Part moved(const Eigen::Vector3f& to, float yaw, const Eigen::Vector3f& new_size,
             const std::string& new_texture) const {
    return {world, at * placed(to.x(), to.y(), to.z(), yaw), new_size, new_texture, tint, dice};
  }
};

void addTable(const Part& part);
void addDesk(const Part& part);
void addChair(const Part& part);
void addOfficeChair(const Part& part);
void addSofa(const Part& part);
void addShelf(const Part& part);
void addCabinet(const Part& part);
void addPlainBox(const Part& part);
void addStack(const Part& part);
void addPlant(const Part& part);
void addBin(const Part& part);
void addPillar(const Part& part);
void addMonitor(const Part& part);
void addClutter(const Part& part);
void addHanging(const Part& part);
void addWindow(const Part& part);
void addRadiator(const Part& part);
void addStool(const Part& part);
void addSlatChair(const Part& part);
void addArmchair(const Part& part);
void addCoatRack(const Part& part);
void addLamp(const Part& part);
void addCurtain(const Part& part);
void addBag(const Part& part);
void addStairs(const Part& part);
void addTrolley(const Part& part);

}  // namespace pf::simulator
