// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "discs.hpp"
#include "posefusion/mesh/surface_nets.hpp"

namespace pf {

/// Signed distance at the corners of the blocks to the planes of the surfels around: their mean,
/// weighted by how near they are (H. Hoppe et al., "Surface reconstruction from unorganized
/// points", 1992; R. Kolluri, "Provably good moving least squares", 2005). Of two sides of a thin
/// thing the nearer one counts. NaN where no surfel speaks.
DistanceField discDistance(const SurfelArrays& surfels, const DiscBlocks& blocks,
                           const MeshConfig& config);

}  // namespace pf
