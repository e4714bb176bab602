// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/slam/status.hpp"
#include "posefusion/tracking/tracker.hpp"

namespace pf {

/// How far the images alone must speak for a pose, see PoseEvidence.
enum class Proof {
  none,    ///< the motion was measured, or is small
  likely,  ///< nothing measured the motion: the images rather speak for the pose than against it
  sure     ///< what was measured says otherwise: as at a place that was searched
};

/// Whether an alignment is believed.
struct Verdict {
  FrameOutcome outcome = FrameOutcome::fused;  ///< `fused`: it is, given `proof`
  std::string detail;
  Proof proof = Proof::none;
};

/// Judges an alignment by itself (overlap, agreement, what is seen through, free directions) and by
/// what is known beside it: the prior, and whether the motion behind that was measured.
Verdict judge(const WorkingFrame& frame, const TrackingResult& result, const PosePrior& prior,
              const TrackingConfig& config);

/// "12 % of the pixels".
std::string percentOf(double part, double whole, const char* what);

/// Poses this near each other say the same.
bool agree(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);

}  // namespace pf
