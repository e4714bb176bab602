// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "posefusion/segmentation/grid.hpp"

namespace pf {

/// What a cell lies on.
enum class Flatness : std::uint8_t {
  none,
  small,  ///< a plane of the size of a body, flatter than one: the back of a chair, a box
  large   ///< a plane larger than a body: floor, wall, table
};

/// Finds the cells of planes, which no person is.
/// A plane is linear in inverse depth over the image, 1/z = a u + b v + c, where the noise of a
/// structured-light sensor is uniform; patches of the grid are fitted and joined to regions.
class PlaneFinder {
 public:
  PlaneFinder();
  ~PlaneFinder();

  void find(const SceneGrid& grid, std::vector<Flatness>& result);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pf
