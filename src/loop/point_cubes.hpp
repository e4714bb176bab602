// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "posefusion/loop/map_points.hpp"

namespace pf {

/// Points around the origin of a grid in cubes, so that a position looks at what can be seen from
/// it and at no more points of it than its distance asks for.
class PointCubes {
 public:
  /// A cube that holds points: at each density those from begin to end.
  struct Cube {
    Eigen::Vector3f centre;
    std::vector<std::uint32_t> begin, end;
  };

  /// Those within `reach_m` of the origin.
  PointCubes(const PointPyramid& pyramid, const Eigen::Isometry3d& T_grid_map, double reach_m);

  const std::vector<Cube>& cubes() const { return cubes_; }
  /// Frame of the grid, in the order of the cubes.
  const PointPyramid& points() const { return points_; }
  static float radius_m();  ///< of the sphere around a cube

 private:
  PointPyramid points_;
  std::vector<Cube> cubes_;
};

}  // namespace pf
