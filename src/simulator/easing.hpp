// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace pf::simulator {

/// From 0 to 1 with no speed at either end, for t from 0 to 1.
inline double smooth(double t) { return t * t * (3.0 - 2.0 * t); }

/// Unit vector of a direction on the floor (rad from x towards y).
inline Eigen::Vector2d direction(double yaw_rad) { return {std::cos(yaw_rad), std::sin(yaw_rad)}; }

}  // namespace pf::simulator
