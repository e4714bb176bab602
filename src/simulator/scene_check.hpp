// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulator/camera_path.hpp"
#include "simulator/raycaster.hpp"
#include "simulator/scenario.hpp"
#include "simulator/world.hpp"

namespace pf::simulator {

/// Throws InputError, naming the entry of the scene file and the place, for things outside of all
/// rooms, and for people that begin or are sent where a person cannot stand.
void checkScene(const Scenario& scenario, const World& world);

/// Throws InputError, naming time and place, when the camera is ever outside all rooms, inside a
/// thing, or closer than 8 cm to one.
void checkCamera(const CameraPath& path, const World& world, const RayCaster& caster,
                 double duration_s);

}  // namespace pf::simulator
