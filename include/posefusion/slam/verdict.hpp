// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/slam/status.hpp"
#include "posefusion/tracking/tracker.hpp"

namespace pf {

/// Whether an alignment is believed.
struct Verdict {
  FrameOutcome outcome = FrameOutcome::fused;  ///< `fused`: it is
  std::string detail;
};

/// Judges an alignment by itself (overlap, agreement, what is seen through, free directions) and by
/// what is known beside it: the prior, and whether the motion behind that was measured.
Verdict judge(const WorkingFrame& frame, const TrackingResult& result, const PosePrior& prior,
              const TrackingConfig& config);

/// Is the alignment good enough to be believed where nothing else is known: after a loss, after a
/// motion that nothing measured? `valid_pixels` are those of the frame.
bool isProof(const TrackingResult& result, int valid_pixels);

/// "12 % of the pixels".
std::string percentOf(double part, double whole, const char* what);

/// Poses this near each other say the same.
bool agree(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);

}  // namespace pf
