// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

namespace pf::synthetic {

/// T_room_camera (optical frame) of a camera held by hand at a moment: it drifts to and fro and
/// looks about, 0.3 m/s and 20 deg/s or so, with a slight tremor. Every motion is a sum of sines
/// whose phases come from the seed.
Eigen::Isometry3d cameraAt(double time_s, std::uint32_t seed);

}  // namespace pf::synthetic
