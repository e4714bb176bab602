// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "posefusion/core/frame.hpp"
#include "posefusion/core/trajectory.hpp"
#include "posefusion/map/surfels.hpp"
#include "posefusion/slam/config.hpp"
#include "posefusion/slam/saved_map.hpp"

namespace pf {

/// A map of one room, and the poses of all its frames.
struct MappedRoom {
  SavedMap saved;
  SurfelArrays stable;
  Trajectory poses;
  Eigen::Vector3d size_m;
};

/// Throws InputError where the frames give no stable surfels.
MappedRoom mapRoom(const std::vector<RgbdFrame>& frames, const Config& config);

/// Copies of the room in rows, each tracked on from the one before: about so many surfels and
/// keyframes. The last copy stands where the room is.
SavedMap buildingOf(const MappedRoom& room, std::size_t surfels, std::size_t keyframes);

}  // namespace pf
