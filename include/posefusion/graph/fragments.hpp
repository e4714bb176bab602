// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>

namespace pf {

/// A camera that is lost for long begins a new piece of the map, a fragment, whose place in the
/// map is not known until a loop joins it. Until then it lies where nothing else does: fragment k
/// is begun at x = k times this (m). Fragment 0 hangs together with the map's origin.
constexpr double kBetweenFragments_m = 500.0;

/// The fragment that a place in the map belongs to.
inline int fragmentAt(double x_m) {
  return static_cast<int>(std::lround(x_m / kBetweenFragments_m));
}

inline int fragmentAt(const Eigen::Isometry3d& T_map_camera) {
  return fragmentAt(T_map_camera.translation().x());
}

}  // namespace pf
