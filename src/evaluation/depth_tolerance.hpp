// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/core/depth_sensor.hpp"

namespace pf {

/// How far (m) a depth of z may be from a surface that it is taken to show: what is fixed stands
/// for the errors of pose and map.
inline float depthTolerance(const DepthSensor& sensor, float z) {
  constexpr float kFixed_m = 0.05F, kSigmas = 3.0F;
  return kFixed_m + kSigmas * sensor.sigma(z);
}

}  // namespace pf
