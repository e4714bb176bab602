// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "posefusion/core/trajectory.hpp"

namespace pf {

/// Sturm et al., "A Benchmark for the Evaluation of RGB-D SLAM Systems", IROS 2012: the definitions
/// of the TUM benchmark, poses matched within 0.02 s.

struct ErrorStatistics {
  std::size_t count = 0;
  double rmse = 0, mean = 0, median = 0, max = 0, min = 0;
  double deviation = 0;    ///< from the mean, over all of them (not n - 1)
  double squares_sum = 0;  ///< of the errors themselves
};

/// Statistics of errors; all 0 of none.
ErrorStatistics statisticsOf(std::vector<double> errors);

/// A true pose and an estimated one of about the same time.
struct PosePair {
  StampedPose truth;
  StampedPose estimate;
};

/// Pairs each stamp at most once, the closest first.
std::vector<PosePair> matchPoses(const Trajectory& truth, const Trajectory& estimate,
                                 std::int64_t max_difference_ns = 20'000'000);

/// truth = scale * rotation * estimate + translation.
struct Alignment {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double scale = 1.0;

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return scale * (rotation * point) + translation;
  }
  /// The pose in the frame of the truth.
  Eigen::Isometry3d operator*(const Eigen::Isometry3d& pose) const;
};

/// The least-squares alignment of the positions (Umeyama 1991). Throws InputError for fewer than
/// three pairs.
Alignment align(const std::vector<PosePair>& pairs, bool with_scale);

/// The rigid motion from the frame of the estimate to that of the truth by rotations and positions:
/// the chordal mean of the rotations between them (Hartley et al., IJCV 2013), then the mean shift.
/// On a short or straight path positions alone leave the rotation almost open. Throws InputError
/// for no pairs.
Eigen::Isometry3d alignPoses(const std::vector<PosePair>& pairs);

/// Absolute trajectory error: distances (m) of the aligned positions.
ErrorStatistics absoluteError(const std::vector<PosePair>& pairs, const Alignment& alignment);

struct RelativeError {
  ErrorStatistics translation_m;  ///< per frame, or per second
  ErrorStatistics rotation_deg;
};

/// Relative pose error from each estimated pose to the next one.
RelativeError relativeErrorPerFrame(const Trajectory& truth, const Trajectory& estimate,
                                    double scale = 1.0);

/// Relative pose error from each estimated pose to that about one second later.
RelativeError relativeErrorPerSecond(const Trajectory& truth, const Trajectory& estimate,
                                     double scale = 1.0);

}  // namespace pf
