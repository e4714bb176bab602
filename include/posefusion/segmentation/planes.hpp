// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "posefusion/segmentation/grid.hpp"

namespace pf {

/// Finds the cells of large planes (floor, walls, table tops): no person is so flat and so large.
/// A plane is linear in inverse depth over the image, 1/z = a u + b v + c, where the noise of a
/// structured-light sensor is uniform; patches of the grid are fitted and joined to regions.
class PlaneFinder {
 public:
  PlaneFinder();
  ~PlaneFinder();

  /// on_plane[cell] = 1 for cells of large planes.
  void find(const SceneGrid& grid, std::vector<std::uint8_t>& on_plane);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pf
