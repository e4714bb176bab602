// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace pf {

enum class TrackingState {
  initializing,  ///< no frame has been fused yet
  tracking,      ///< located, fused
  doubtful,      ///< located for now by dead reckoning or by an alignment that is not trusted; not
                 ///< fused
  lost           ///< not located
};

/// The outcome of a frame: why it was fused or not.
enum class FrameOutcome {
  fused,          ///< trusted, and fused into the map
  bad_input,      ///< sizes, encodings or stamps that cannot be used
  blurred,        ///< dropped by the gate
  no_depth,       ///< too few valid pixels to track (all zero, covered, people everywhere)
  not_converged,  ///< the alignment did not settle
  few_inliers,    ///< too little of the frame agrees with the model
  degenerate,     ///< the images leave directions free, and no corners help
  jumped,         ///< the motion is too large to be true
  disagrees,      ///< alignment and corners measure different motions
  seen_through,   ///< the frame sees through too much of the model
  unproven,       ///< after a loss: looks right, but not for long enough
  forced,         ///< passed the blur gate only because too many were dropped before it
  located         ///< trusted like a fused one, in a map that must not change
};

/// Whether the frame was trusted, so that there is nothing to report.
inline bool isGood(FrameOutcome outcome) {
  return outcome == FrameOutcome::fused || outcome == FrameOutcome::located;
}

std::string_view name(TrackingState state);
std::string_view name(FrameOutcome outcome);

}  // namespace pf
