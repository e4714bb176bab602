// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "posefusion/pose/skeleton.hpp"

namespace pf {

/// Joints in space, indexed by Joint; NaN where a joint is not seen or has no depth.
using SkeletonPoints = std::array<Eigen::Vector3f, kJointCount>;

/// A skeleton of which nothing is known.
SkeletonPoints unknownSkeleton();

/// A person, or anything else that moves: a chair that is pushed, a door.
struct MovingObject {
  int id = 0;              ///< from 1 on, the same over frames; people have numbers of their own
  bool is_person = false;  ///< detected as one
  std::vector<Eigen::Vector3f> points_m;               ///< samples of what is seen of it
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  ///< mean of the points
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
  SkeletonPoints joints_m = unknownSkeleton();  ///< of a person

  /// It is now at these points, at least one, `elapsed_s` after it was last placed. The velocity is
  /// the mean over a third of a second.
  void placeAt(std::vector<Eigen::Vector3f> points_m, double elapsed_s);

  /// The box around the points, along the axes.
  Eigen::AlignedBox3d box_m() const;

  /// The same in another frame.
  MovingObject in(const Eigen::Isometry3d& T) const;
};

}  // namespace pf
