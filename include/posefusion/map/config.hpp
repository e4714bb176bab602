// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/config/fields.hpp"

namespace pf {

/// Settings of the surfel map.
struct MapConfig {
  int shrink = 1;
  double stable_probability = 0.76;
  double max_normal_angle_rad = 0.8;
  double max_weight = 8.0;
  double max_unstable_age_s = 1.0;
  double active_window_s = 3600.0;
  double memory_limit_mb = 1024.0;
};

inline void visitFields(MapConfig& c, FieldVisitor& v) {
  v.integer(
      "shrink", c.shrink, 1, 8,
      "near surfaces get a surfel for each pixel of images shrunk by this factor, farther ones "
      "of images halved until a pixel is as wide as half the standard deviation of its depth, "
      "but never coarser than those that tracking sees (frame.shrink)");
  v.number(
      "stable_probability", c.stable_probability, 0.0, 0.96,
      "a surfel that stands still with this probability is stable (0.27 s of views that agree "
      "make 0.76 of 0.5, no number of them more than 0.97): it then hides others and is saved");
  v.number("max_normal_angle_rad", c.max_normal_angle_rad, 0.01, 3.14,
           "largest angle between the normals of a surfel and of a measurement merged into it");
  v.number("max_weight", c.max_weight, 1.0, 1e6,
           "the running mean forgets beyond this weight (measurements at 1 m count 1)");
  v.number("max_unstable_age_s", c.max_unstable_age_s, 0.0, 1e6,
           "an unstable surfel not supported for so long, while frames are fused, is removed");
  v.number("active_window_s", c.active_window_s, 0.0, 1e9,
           "surfels supported within so long, while frames are fused, are active: tracked against "
           "and fused into");
  v.number("memory_limit_mb", c.memory_limit_mb, 1.0, 1e6,
           "memory the surfels may take; a full map takes no new ones");
}

}  // namespace pf
