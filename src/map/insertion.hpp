// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "posefusion/frame/working_frame.hpp"
#include "posefusion/map/fusion.hpp"
#include "posefusion/map/surfels.hpp"
#include "seen_space.hpp"
#include "surfel_update.hpp"

namespace pf {

/// Makes a surfel of each pixel with depth and normal that is kUnexplained, row by row.
/// What stands before a surface that is known, or in space that was seen free, has to be seen for
/// longer until it counts as stable.
/// Reuses the memory of `surfels`; `now` is the number of the frame.
void surfelsOfUnexplained(const WorkingFrame& frame, const Eigen::Isometry3d& T_map_camera,
                          const FusionOptions& options, int now, const Evidence& evidence,
                          const SeenSpace::FromCamera& seen, SurfelArrays& surfels);

}  // namespace pf
