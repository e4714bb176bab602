// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/config/fields.hpp"

namespace pf {

/// Settings of the blur gate.
struct BlurConfig {
  bool enabled = true;
  double threshold = 0.0;
  double relative_threshold = 0.2;
  double history_s = 1.0;
  double max_gap_s = 0.2;
};

inline void visitFields(BlurConfig& c, FieldVisitor& v) {
  v.flag("enabled", c.enabled, "drop blurred frames");
  v.number("threshold", c.threshold, 0.0, 1e6,
           "fixed threshold on the variance of the Laplacian (grey levels squared); 0 = adaptive");
  v.number(
      "relative_threshold", c.relative_threshold, 0.0, 1.0,
      "adaptive: a frame is blurred if its fine detail, for its coarse detail, is below this part "
      "of the median of the recent frames");
  v.number("history_s", c.history_s, 0.0, 1e4,
           "adaptive: the frames of so long, dropped ones too, make the median; at least twice a "
           "burst of blur (s)");
  v.number("max_gap_s", c.max_gap_s, 0.0, 1e3,
           "a blurred frame passes, to be located but not fused, when none has for so long (s)");
}

}  // namespace pf
