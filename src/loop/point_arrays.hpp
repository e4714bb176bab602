// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "posefusion/loop/map_points.hpp"

namespace pf {

/// All that a point has: x, y, z, the normal, the grey level. Of MapPoints, const or not.
template <typename Points>
auto pointArrays(Points& p) {
  return std::array{&p.x, &p.y, &p.z, &p.nx, &p.ny, &p.nz, &p.intensity};
}

}  // namespace pf
