// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "posefusion/map/surfels.hpp"

namespace pf {

/// From a frame whose z is about up (within 25 degrees) to one that stands level on the floor: z is
/// up from it, x and y are turned as little as that takes. The floor is the lowest plane that is
/// not small against the largest one that faces up. Throws InputError where nothing faces up.
Eigen::Isometry3d floorFrame(const SurfelArrays& surfels);

}  // namespace pf
