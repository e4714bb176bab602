// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "posefusion/segmentation/grid.hpp"
#include "posefusion/segmentation/tracked_people.hpp"

namespace pf {

/// For every cell the nearest body.
struct BodyDistance {
  std::vector<float> relative;      ///< distance to the line of the nearest capsule in units of its
                                    ///< radius (1 = on the surface)
  std::vector<std::int16_t> owner;  ///< index of the person, -1: none within the limit
};

/// Measures the distance of every cell to all bodies, in space, up to `limit` capsule radii. Cells
/// without depth are taken to be at the body's depth.
void measureDistance(const std::vector<TrackedPerson>& people, const SceneGrid& grid, float limit,
                     BodyDistance& distance);

}  // namespace pf
