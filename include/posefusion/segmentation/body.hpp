// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "posefusion/pose/skeleton.hpp"
#include "posefusion/segmentation/grid.hpp"

namespace pf {

/// A limb of a body in the camera frame: the line between two joints and how far the body reaches
/// around it. A joint without a neighbour is a capsule of length zero.
struct Capsule {
  Eigen::Vector3f from = Eigen::Vector3f::Zero();
  Eigen::Vector3f to = Eigen::Vector3f::Zero();
  float radius_m = 0.1F;
};

/// A person's joints lifted into the scene.
struct Body {
  std::vector<Capsule> capsules;
  std::vector<int> seeds;    ///< cells that belong to the person for sure
  std::vector<int> shown;    ///< cells that the detector's mask shows for sure
  std::vector<int> anchors;  ///< seeds, shown cells, and carried cells in front of the map
  float depth_m = 0.0F;      ///< median depth of the seeds, 0: no seed has depth
};

/// Lifts a person: joints, and samples along limbs between seen joints, get the median depth of
/// their neighbourhood; samples far from the person's median depth (lifted onto the wall behind or
/// the table in front) are dropped. Where `near_depth_m` is above 0, the median must be close to
/// it: so a carried person does not jump to another person walking in front.
Body liftPerson(const Person& person, const SceneGrid& grid, float near_depth_m = 0.0F);

}  // namespace pf
