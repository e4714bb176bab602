// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "simulator/furniture.hpp"

namespace pf::simulator {

/// In pictures a person is labelled by 1 + its number, a thing by kFirstThing + its number, in
/// eight bits.
constexpr std::uint32_t kFirstThing = 100;
constexpr std::size_t kMostPeople = 30, kMostThings = 150;

/// Where a thing is: the origin of its own frame in the world, and its direction. Things stay
/// upright.
struct ThingPose {
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;

  Eigen::Isometry3d matrix() const;  ///< T_world_thing
  bool operator==(const ThingPose& other) const {
    return at_m == other.at_m && yaw_rad == other.yaw_rad;
  }
};

/// Between two poses, `t` in [0, 1]; `b.yaw_rad - a.yaw_rad` may be more than half a turn.
ThingPose interpolate(const ThingPose& a, const ThingPose& b, double t);

/// A thing moves by itself: along a path, or about its hinge.
struct ThingMove {
  enum class When { time, seen, unseen };
  double at_s = 0.0;       ///< not before
  When when = When::time;  ///< seen, unseen: waits until the camera sees it, or cannot see it
  double over_s = 2.0;     ///< from rest to rest
  double turn_rad = 0.0;   ///< along the path, or about the hinge
  std::vector<Eigen::Vector3d> path_m;  ///< places after the one where it is; z NaN: as it stands
};

/// A thing of a scene file that may move. `object.at_m` and `object.yaw_rad` are its first pose.
struct ThingSpec {
  std::string name;
  ObjectSpec object;
  Eigen::Vector2d hinge_m = Eigen::Vector2d::Zero();  ///< in its own frame
  std::vector<ThingMove> moves;                       ///< in the order of their times
};

/// A thing in its own frame: what is drawn, and how far it reaches.
struct ThingShape {
  Mesh mesh;
  Eigen::AlignedBox3d box;
};

/// Builds a thing; its materials become the world's, nothing else of it does.
ThingShape makeThing(World& world, const ObjectSpec& spec);

/// Adds a thing at a pose to a mesh of the same world; patches are left out.
void append(const Mesh& thing, const ThingPose& pose, Mesh& mesh);

}  // namespace pf::simulator
