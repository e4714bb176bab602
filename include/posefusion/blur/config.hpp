// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/config/fields.hpp"

namespace pf {

/// Settings of the blur gate.
struct BlurConfig {
  bool enabled = true;
  double threshold = 0.0;
  double relative_threshold = 0.25;
  int history_frames = 30;
  int max_consecutive_drops = 15;
};

inline void visitFields(BlurConfig& c, FieldVisitor& v) {
  v.flag("enabled", c.enabled, "drop blurred frames");
  v.number("threshold", c.threshold, 0.0, 1e6,
           "fixed threshold on the variance of the Laplacian (grey levels squared); 0 = adaptive");
  v.number("relative_threshold", c.relative_threshold, 0.0, 1.0,
           "adaptive: a frame is blurred below this part of the median of the recent sharp scores");
  v.integer("history_frames", c.history_frames, 1, 10000,
            "adaptive: how many accepted scores are remembered");
  v.integer("max_consecutive_drops", c.max_consecutive_drops, 0, 10000,
            "after so many drops in a row the next frame passes whatever its score");
}

}  // namespace pf
