// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/config/fields.hpp"

namespace pf {

/// Settings of the loop closer.
struct LoopConfig {
  bool enabled = true;
  int ferns = 500;
  int fern_seed = 1;
  double fern_novelty = 0.3095;
  bool static_view_rule = true;
  int min_gap_keyframes = 10;
  double near_m = 1.5;
  int candidates = 6;
  int enough_loops = 3;
  double answer_lag_s = 0.333;
  double new_fragment_after_s = 4.0;
  bool refine_at_end = true;
};

inline void visitFields(LoopConfig& c, FieldVisitor& v) {
  v.flag("enabled", c.enabled, "look for places that were seen before");
  v.integer("ferns", c.ferns, 1, 100000, "randomised ferns that describe a keyframe");
  v.integer("fern_seed", c.fern_seed, 0, 1000000000, "the same seed gives the same ferns");
  v.number("fern_novelty", c.fern_novelty, 0.0, 1.0,
           "a keyframe's ferns are stored when it differs from all others by more than this");
  v.flag("static_view_rule", c.static_view_rule,
         "ferns are stored only without people in view (off in the modes elastic and posefusion)");
  v.integer("min_gap_keyframes", c.min_gap_keyframes, 1, 100000,
            "a loop leads back over at least so many keyframes");
  v.number("near_m", c.near_m, 0.0, 1000.0, "keyframes nearer than this are compared");
  v.integer("candidates", c.candidates, 0, 1000,
            "most near keyframes that a keyframe is compared with");
  v.integer("enough_loops", c.enough_loops, 1, 1000,
            "a keyframe that has so many loops is compared with no more");
  v.number("answer_lag_s", c.answer_lag_s, 0.0, 100.0,
           "from a question to the loop closer to its answer, and from there to the correction of "
           "the map, offline and in lossless replay (s, counted in frames at the pace of the "
           "camera)");
  v.number("new_fragment_after_s", c.new_fragment_after_s, 0.0, 1e6,
           "a lost camera that sees something for so long begins a new piece of the map, until its "
           "place is known; 0: never");
  v.flag("refine_at_end", c.refine_at_end,
         "after the last frame, offline and in lossless replay, all keyframes that see the same "
         "surface are aligned with each other, where depth is corrected or known to be right");
}

}  // namespace pf
