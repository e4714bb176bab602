// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "simulator/furniture.hpp"

namespace pf::simulator {

/// What rooms may be furnished as.
std::vector<std::string> furnitureStyles();

/// The things of a furnished room, drawn by the seed of its furniture: along the walls, apart from
/// doorways, and a group in the middle that can be walked round. Rooms of the same size, doorways
/// and furniture are alike. None for a room without furniture.
std::vector<ObjectSpec> furnish(const RoomSpec& room);

}  // namespace pf::simulator
