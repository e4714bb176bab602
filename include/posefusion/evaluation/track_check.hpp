// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/evaluation/metrics.hpp"

namespace pf {

/// What is known of the recording beside its true poses. Stamps in nanoseconds, in order.
struct TrackFacts {
  std::vector<std::int64_t> frames_ns;   ///< of all frames; empty: not known
  std::vector<std::int64_t> blurred_ns;  ///< of the frames that are blurred
};

/// How many frames have a pose.
struct PoseCoverage {
  std::size_t frames = 0, posed = 0;              ///< of all frames
  std::size_t sharp_frames = 0, sharp_posed = 0;  ///< of those that are not blurred

  double share() const;       ///< posed / frames; 1 of none
  double sharpShare() const;  ///< sharp_posed / sharp_frames; 1 of none
};

PoseCoverage coverageOf(const Trajectory& estimate, const TrackFacts& facts);

/// Beyond these a motion over a second is no drift: the camera is not where the estimate says.
constexpr double kWrongDistance_m = 0.10;
constexpr double kWrongAngle_deg = 5.0;

/// Indices of the estimated poses whose motion since the last pose that is at least a second older
/// (in the first second: since the first pose) is off by more than kWrongDistance_m or
/// kWrongAngle_deg: locks on a wrong place, and slides. Slow drift is not among them, nor is where
/// a wrong lock was kept. The truth is interpolated; poses that no true pose is within 0.02 s of
/// are left out.
std::vector<std::size_t> wrongPoses(const Trajectory& truth, const Trajectory& estimate);

/// How far the poses are from the truth if only the start of the camera is known: the frames are
/// brought together by alignPoses() over the poses of the first second that has any, never by a fit
/// to what comes later.
struct PlaceErrors {
  ErrorStatistics distance_m;   ///< of the poses that have a true one
  double worst_deg = 0;         ///< the largest angle between the two
  std::size_t false_count = 0;  ///< poses off by more than kWrongDistance_m or kWrongAngle_deg
  Eigen::Isometry3d T_truth_estimate = Eigen::Isometry3d::Identity();  ///< the alignment
};

/// Drift counts, and so does a place that is wrong and kept. The truth is interpolated. Throws
/// InputError when no pose has a true one within 0.02 s.
PlaceErrors placeErrors(const Trajectory& truth, const Trajectory& estimate);

/// Absolute error of all frames from the first pose on: a frame without a pose counts with the last
/// one before it. Aligned as for the poses alone (`alignment`), so that holding a pose can only be
/// as good as the pose. Frames without a true pose within 0.02 s are left out.
ErrorStatistics heldError(const Trajectory& truth, const Trajectory& estimate,
                          const std::vector<std::int64_t>& frames_ns, const Alignment& alignment);

/// Distance (m) of the last pose that has a true one, in the given alignment; 0 of none.
double lastError(const Trajectory& truth, const Trajectory& estimate, const Alignment& alignment);

}  // namespace pf
