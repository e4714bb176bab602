// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// Layers of one surface are so far apart (m): what is nearer is one, what is farther is a surface
/// of its own.
constexpr float kLeastLayer_m = 0.015F, kMostLayer_m = 0.10F;

/// Once a correction has laid two passes over each other, what is left between them: removes the
/// stable surfels through which, along their normal, runs the line to the disc of an older stable
/// one of their fragment that faces the same way and is 1.5 cm to kMostLayer_m off. As in fusion,
/// the older layer is the right one: the trajectory hangs on it. (A frame can only contradict what
/// it sees; the layers that a correction makes are out of view, most of them.) Returns how many
/// went. The result does not depend on the number of threads.
std::size_t removeYoungerLayers(SurfelMap& map);

/// The same where at least one of the two layers is in one of these blocks.
std::size_t removeYoungerLayers(SurfelMap& map, const std::vector<std::uint32_t>& blocks);

}  // namespace pf
