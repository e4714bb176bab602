// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/color_camera.hpp"

#include <cmath>
#include <cstdio>

namespace pf {

std::string describe(const ColorCamera& c) {
  char text[160];
  std::snprintf(text, sizeof(text),
                "fx %.1f fy %.1f cx %.1f cy %.1f, the depth camera %.1f mm %s of it", c.fx, c.fy,
                c.cx, c.cy, 1e3 * std::abs(c.depth_right_m),
                c.depth_right_m < 0 ? "left" : "right");
  return text;
}

}  // namespace pf
