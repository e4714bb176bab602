// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulator/camera_path.hpp"
#include "simulator/raycaster.hpp"

namespace pf::simulator {

/// Throws InputError, naming time and place, when the camera is ever outside all rooms, inside a
/// thing, or closer than 8 cm to one.
void checkCamera(const CameraPath& path, const World& world, const RayCaster& caster,
                 double duration_s);

}  // namespace pf::simulator
