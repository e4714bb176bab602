// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// A copy of the stable surfels of the first fragment, block by block, in another frame (positions
/// in m): what a map file gives to others.
SurfelArrays stableSurfels(const SurfelMap& map, const Eigen::Isometry3d& T_out_map);

}  // namespace pf
