// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "posefusion/graph/keyframe.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// Where a correction has moved surfels that lie close to each other differently, so that they may
/// have become layers of one surface: the places of those blocks, ascending. `before`, `now`: map
/// and keyframes (the same ones) before and after. Where all goes along nothing can have become
/// double, however far it went.
std::vector<std::uint32_t> tornBlocks(const SurfelMap& before, const SurfelMap& now,
                                      const std::vector<Keyframe>& keyframes_before,
                                      const std::vector<Keyframe>& keyframes_now);

}  // namespace pf
