// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/config/fields.hpp"

namespace pf {

/// Settings of the working frame that tracking, map and segmentation share.
struct FrameConfig {
  double min_depth_m = 0.3;
  double max_depth_m = 8.0;
  int shrink = 0;
};

inline void visitFields(FrameConfig& c, FieldVisitor& v) {
  v.number("min_depth_m", c.min_depth_m, 0.01, 100.0, "nearer depth is not used");
  v.number("max_depth_m", c.max_depth_m, 0.1, 100.0, "farther depth is not used");
  v.integer(
      "shrink", c.shrink, 0, 8,
      "tracking and map work on images shrunk by this factor; every pixel still counts, each "
      "shrunk pixel is the mean of its block; 0: the factor by which a pixel is nearest to the "
      "angle that one of a Kinect's has at 320x240");
}

/// The factor for a camera of this focal length (pixels): `shrink`, or computed where it is 0.
int shrinkFor(const FrameConfig& config, double focal_px);

}  // namespace pf
