// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "posefusion/core/depth_sensor.hpp"
#include "posefusion/map/fusion.hpp"

namespace pf {

/// Weight of a measurement: 1 / variance, 1 at a distance of 1 m.
inline float measurementWeight(const DepthSensor& sensor, float z) {
  const float ratio = sensor.sigma(1.0F) / sensor.sigma(z);
  return std::min(ratio * ratio, 2.0F);
}

/// Radius (m) of the disc that fills a pixel's footprint on a surface seen at this cosine, at most
/// doubled. It reaches to the neighbouring pixels' centres, so that discs overlap and leave no
/// holes.
inline float footprintRadius(float z, float fx, float cosine) {
  return z / fx / std::max(cosine, 0.5F);
}

/// A colour of the frame as the map's exposure would show it, 0..255.
inline float exposed(unsigned char value, const FusionOptions& options) {
  return std::min(255.0F,
                  std::max(0.0F, options.gain * static_cast<float>(value) + options.offset));
}

}  // namespace pf
