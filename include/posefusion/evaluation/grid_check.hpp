// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "posefusion/grid/occupancy_grid.hpp"

namespace pf {

/// Cells of a grid against the true room.
struct GridScore {
  std::size_t seen = 0, right = 0;
  std::size_t false_free = 0, false_occupied = 0;
  std::size_t near = 0;  ///< of the wrong ones: right for a cell beside them

  double share() const;  ///< right / seen, 0 of none
};

/// `truth`: points all over the true surface (m), densely against the cells, with z over the floor;
/// `T_truth_floor` brings the frame of the grid into theirs. A cell is truly occupied where there
/// is surface between the heights of `config`.
GridScore checkGrid(const OccupancyGrid& grid, const GridConfig& config,
                    const Eigen::Isometry3d& T_truth_floor,
                    const std::vector<Eigen::Vector3f>& truth);

}  // namespace pf
