// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/graph/deformation.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// Moves each surfel, position and normal, by the correction of the fragment that it is in and of
/// the frame that it was made in (SurfelArrays::created), and takes those that left the cube of
/// their block, or whose fragment becomes part of another, into the blocks where they are now.
/// Surfels whose correction is the identity keep all their bits and, but for that, their block. As
/// in SurfelMap::add(), what no memory is left for is refused and counted. The result does not
/// depend on the number of threads.
void deform(SurfelMap& map, const Deformation& deformation);

}  // namespace pf
