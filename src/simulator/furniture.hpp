// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "simulator/random.hpp"
#include "simulator/world.hpp"

namespace pf::simulator {

/// A thing of a scene file. Furniture stands on the floor with its front towards its +x; what hangs
/// on a wall (poster, window, door ...) has its back there and shows along its +x.
struct ObjectSpec {
  std::string kind;
  std::string texture;  ///< empty: the kind's own
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
  std::optional<Eigen::Vector3d> size_m;  ///< along x, y, z of the thing
  std::optional<Eigen::Vector3d> color;   ///< tint, linear 0..1
  std::uint32_t seed = 0;
};

/// Adds the thing and its footprint. Throws InputError naming an unknown kind and the known ones.
void addObject(World& world, const ObjectSpec& spec);

std::vector<std::string> objectKinds();

/// An opening in a wall, for walking through.
struct Doorway {
  std::string wall;   ///< south (-y), north (+y), west (-x), east (+x)
  double at_m = 0.0;  ///< middle, from the wall's low end
  double width_m = 0.9;
  double height_m = 2.05;
};

/// How a room is furnished; see furnish(). Without a style it is empty.
struct Furniture {
  std::string style;
  std::uint32_t seed = 0;
};

/// A room with its low corner on the floor.
struct RoomSpec {
  std::string name;  ///< may be empty
  std::string like;  ///< name of the room that it was copied from
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();
  Eigen::Vector3d size_m{6.0, 5.0, 2.7};
  std::string floor = "carpet";
  std::string walls = "plaster";
  std::string ceiling = "blank";
  Eigen::Vector3d wall_color = Eigen::Vector3d::Ones();
  Eigen::Vector3d floor_color = Eigen::Vector3d::Ones();
  std::vector<Doorway> doorways;
  Furniture furniture;
  int lamps_x = 2;
  int lamps_y = 2;
  double lamp_radiance = 9.0;
};

/// Adds floor, ceiling, walls with doorways and their reveals, skirting and ceiling lamps.
void addRoom(World& world, const RoomSpec& spec, std::uint32_t seed);

}  // namespace pf::simulator
