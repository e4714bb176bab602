// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/grid/occupancy_grid.hpp"
#include "posefusion/mesh/triangle_mesh.hpp"

namespace pf {

/// How a floor plan is drawn.
struct PlanConfig {
  double cut_m = 1.2;   ///< walls are what a level plane cuts so high over the floor
  double scale = 50;    ///< one to this: millimetres on paper
  std::string title{};  ///< one line below the plan
};

/// Throws InputError naming the first value that cannot be.
void validate(const PlanConfig& config);

/// Lines in the plane of a cut: consecutive points are joined.
using Outline = std::vector<Eigen::Vector2f>;

/// Where a level plane cuts a mesh, corner by corner along the cut. Triangles give one piece each,
/// which are joined where they share an edge. The order depends on the mesh alone.
std::vector<Outline> cutLevel(const TriangleMesh& mesh, float height_m);

/// A floor plan as SVG (W3C, "Scalable Vector Graphics 1.1"), as large as it is on paper: floor
/// that is free, what stands on it, walls as lines, a bar with metres. Grid and mesh are in the
/// frame of the floor. Throws InputError where nothing of the grid is known.
std::string floorPlan(const OccupancyGrid& grid, const TriangleMesh& mesh,
                      const PlanConfig& config);

}  // namespace pf
