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

/// 640x480 pixels, as of an Xtion.
inline PinholeCamera vga() {
  PinholeCamera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 525;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

}  // namespace pf
