// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/core/camera.hpp"

namespace pf {

/// 160x120 pixels, 63 degrees wide.
inline PinholeCamera smallCamera() {
  PinholeCamera camera;
  camera.width = 160;
  camera.height = 120;
  camera.fx = camera.fy = 130;
  camera.cx = 79.5;
  camera.cy = 59.5;
  return camera;
}

}  // namespace pf
