// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulator/world.hpp"

namespace pf::simulator {

/// How far the middle of a walker keeps from walls and furniture.
constexpr double kWalkClearance_m = 0.30;

/// The floor as cells of 10 cm that people can or cannot walk on.
class Walkway {
 public:
  /// Inside the rooms and their doorways, `clearance_m` away from walls and furniture.
  Walkway(const World& world, double clearance_m);

  bool isFree(const Eigen::Vector2d& p) const;

  /// Whether a body can be there, whatever stands on the floor: a little away from walls, or in a
  /// doorway.
  bool isFloor(const Eigen::Vector2d& p) const;

  /// The nearest free place.
  Eigen::Vector2d nearestFree(const Eigen::Vector2d& p) const;

  /// From now on only what can be reached from there is free.
  void keepReachable(const Eigen::Vector2d& from);

  /// Whether a way leads from one to the other, each moved to the nearest free place.
  bool connects(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

  /// A way as a few straight legs, ends included; the straight line when there is none.
  std::vector<Eigen::Vector2d> findWay(const Eigen::Vector2d& from,
                                       const Eigen::Vector2d& to) const;

 private:
  int cellAt(const Eigen::Vector2d& p) const;
  Eigen::Vector2d centreOf(int cell) const;
  bool seesFree(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const;
  std::vector<int> search(int from, int to) const;
  std::vector<int> freeAround(int cell) const;

  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  int columns_ = 1, rows_ = 1;
  std::vector<char> free_;
  std::vector<Eigen::AlignedBox3d> rooms_;
  std::vector<Footprint> passages_;
};

}  // namespace pf::simulator
