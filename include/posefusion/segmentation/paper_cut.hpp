// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "posefusion/pose/skeleton.hpp"
#include "posefusion/segmentation/graph_cut.hpp"
#include "posefusion/segmentation/grid.hpp"

namespace pf {

/// The paper's smoothness cost C = exp(-(length / sigma)^2) (PFH paper, eq. 2).
float smoothnessCost(float length_m, float sigma_m);

/// The paper's background penalty P = horizontal distance to the nearest seed / radius (eq. 3).
/// `up`: unit vector, the distance is measured perpendicular to it.
float backgroundPenalty(const Eigen::Vector3f& point, const std::vector<Eigen::Vector3f>& seeds,
                        const Eigen::Vector3f& up, float radius_m);

/// The joints that were detected, lifted by the depth at their place; those without are left out.
std::vector<Eigen::Vector3f> liftJoints(const People& people, const SceneGrid& grid);

struct PaperTerms {
  float sigma_m = 0.25F;
  float radius_m = 0.20F;
  int neighbours = 14;             ///< of each point, itself included (PCL's default)
  float foreground_weight = 0.8F;  ///< paid by a point called background (PCL's default)
  Eigen::Vector3f up = Eigen::Vector3f::UnitZ();  ///< in the camera frame; replaced by the optical
                                                  ///< axis where gravity is not known
};

/// The segmentation of the paper (III-B) as pcl::MinCutSegmentation does it (Golovinskiy and
/// Funkhouser 2009): each point of the cloud is a vertex, joined to its nearest neighbours in
/// space. Keeps its memory.
class PaperCutter {
 public:
  /// Cuts the cells with depth. `labels`: 1 = on the seeds' side of the cheapest cut. Returns the
  /// cost of that cut.
  double cut(const SceneGrid& grid, const std::vector<Eigen::Vector3f>& seeds,
             const PaperTerms& terms, std::vector<std::uint8_t>& labels);

 private:
  GraphCut graph_;
  std::vector<int> node_;                     // of each cell, -1: no depth
  std::vector<std::vector<int>> neighbours_;  // of each cell, itself left out
};

}  // namespace pf
