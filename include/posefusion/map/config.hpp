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
  int max_unstable_age_frames = 30;
  int active_window_frames = 100000;
  double memory_limit_mb = 1024.0;
};

inline void visitFields(MapConfig& c, FieldVisitor& v) {
  v.number("stable_confidence", c.stable_confidence, 0.0, 1e6,
           "frames that must have supported a surfel before it counts as stable: it then hides "
           "unstable ones and is saved");
  v.number("max_normal_angle_rad", c.max_normal_angle_rad, 0.01, 3.14,
           "largest angle between the normals of a surfel and of a measurement merged into it");
  v.number("max_weight", c.max_weight, 1.0, 1e6,
           "the running mean forgets beyond this weight (measurements at 1 m count 1)");
  v.integer("max_violations", c.max_violations, 1, 200,
            "a surfel is removed when more frames contradict it than this and than have supported "
            "it (of whom 24 count at most)");
  v.integer("max_unstable_age_frames", c.max_unstable_age_frames, 1, 1000000,
            "an unstable surfel not supported for so long is removed");
  v.integer("active_window_frames", c.active_window_frames, 1, 1000000000,
            "surfels supported within so many frames are active: tracked against and fused into");
  v.number("memory_limit_mb", c.memory_limit_mb, 1.0, 1e6,
           "memory the surfels may take; a full map takes no new ones");
}

}  // namespace pf
