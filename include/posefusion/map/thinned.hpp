// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/map/surfels.hpp"

namespace pf {

/// One surfel in each cube of `voxel_m` that has any: the mean of position, normal, colour and
/// radius, by their weights. In the order in which the cubes come first. Those that are
/// not finite are left out, as are cubes whose normals cancel.
SurfelArrays thinned(const SurfelArrays& surfels, float voxel_m);

}  // namespace pf
