// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "shape.hpp"

namespace pf::synthetic {

/// A furnished living room, 5.2 x 4.6 x 2.6 m, origin in a corner of the floor, x along the long
/// wall, y away from the camera, z up. The middle of the floor is free to walk on.
std::vector<Shape> makeRoom();

}  // namespace pf::synthetic
