// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/evaluation/metrics.hpp"

namespace pf {

/// What is known of the recording beside its true poses. Stamps in nanoseconds, in order.
struct TrackFacts {
  std::vector<std::int64_t> frames_ns;        ///< of all frames; empty: not known
  std::vector<std::int64_t> blurred_ns;       ///< of the frames that are blurred
  std::optional<std::int64_t> first_fall_ns;  ///< when the camera first falls
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

/// Distances from the truth once the frames are brought together by alignPoses() over the poses
/// before the first fall (without one: of the first five seconds).
struct PlaceErrors {
  std::size_t count = 0;        ///< poses that have a true one
  std::size_t false_count = 0;  ///< of them farther off than kWrongDistance_m; drift counts too
  double worst_m = 0;
  Eigen::Isometry3d T_truth_estimate = Eigen::Isometry3d::Identity();  ///< the alignment
};

/// Throws InputError when no pose has a true one.
PlaceErrors placeErrors(const Trajectory& truth, const Trajectory& estimate,
                        const TrackFacts& facts);

/// Absolute error of all frames from the first pose on: a frame without a pose counts with the last
/// one before it. Aligned as for the poses alone (`alignment`), so that holding a pose can only be
/// as good as the pose. Frames without a true pose within 0.02 s are left out.
ErrorStatistics heldError(const Trajectory& truth, const Trajectory& estimate,
                          const std::vector<std::int64_t>& frames_ns, const Alignment& alignment);

/// Distance (m) of the last pose that has a true one, in the given alignment; 0 of none.
double lastError(const Trajectory& truth, const Trajectory& estimate, const Alignment& alignment);

}  // namespace pf
