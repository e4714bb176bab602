// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "posefusion/graph/deformation.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// Moves each surfel, position and normal, by the correction of the fragment that it is in and of
/// the frame that it was made in (SurfelArrays::created); it stays in its block, and blocks become
/// part of another fragment with theirs. Surfels whose correction is the identity keep all their
/// bits. The result does not depend on the number of threads.
void deform(SurfelMap& map, const Deformation& deformation);

/// The same of some blocks.
void deform(SurfelMap& map, const Deformation& deformation,
            const std::vector<std::uint32_t>& blocks);

}  // namespace pf
