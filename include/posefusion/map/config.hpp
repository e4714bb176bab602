// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/config/fields.hpp"

namespace pf {

/// Settings of the surfel map.
struct MapConfig {
  double stable_confidence = 8.0;
  double max_normal_angle_rad = 0.8;
  double max_weight = 8.0;
  int max_violations = 6;
  double max_unstable_age_s = 1.0;
  double active_window_s = 3600.0;
  double memory_limit_mb = 1024.0;
};

inline void visitFields(MapConfig& c, FieldVisitor& v) {
  v.number("stable_confidence", c.stable_confidence, 0.0, 1e6,
           "support that makes a surfel stable, in frames at 30 Hz (a frame at 10 Hz counts 3): it "
           "then hides unstable ones and is saved");
  v.number("max_normal_angle_rad", c.max_normal_angle_rad, 0.01, 3.14,
           "largest angle between the normals of a surfel and of a measurement merged into it");
  v.number("max_weight", c.max_weight, 1.0, 1e6,
           "the running mean forgets beyond this weight (measurements at 1 m count 1)");
  v.integer("max_violations", c.max_violations, 1, 200,
            "a surfel is removed when more frames (at 30 Hz) contradict it than this and than have "
            "supported it (24 of these count at most)");
  v.number("max_unstable_age_s", c.max_unstable_age_s, 0.0, 1e6,
           "an unstable surfel not supported for so long, while frames are fused, is removed");
  v.number("active_window_s", c.active_window_s, 0.0, 1e9,
           "surfels supported within so long, while frames are fused, are active: tracked against "
           "and fused into");
  v.number("memory_limit_mb", c.memory_limit_mb, 1.0, 1e6,
           "memory the surfels may take; a full map takes no new ones");
}

}  // namespace pf
