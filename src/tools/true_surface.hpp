// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/evaluation/surface_check.hpp"

namespace pf {

/// The true surface of a simulated sequence (scene_points.ply). Throws InputError naming the file.
SurfaceSamples trueSurface(const std::string& sequence);

}  // namespace pf
