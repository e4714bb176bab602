// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "posefusion/core/se3.hpp"
#include "posefusion/core/trajectory.hpp"

namespace pf {

/// An estimated pose with the covariance of its error: of the twist (m, rad) in the camera frame.
struct UncertainPose {
  std::int64_t stamp_ns = 0;
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();
};

/// How often the reported covariance covers the true error of a motion.
struct CovarianceShare {
  std::size_t motions = 0;
  double within = 0;             ///< share of the motions with all six axes within 3 sigma
  double within_ellipsoid = 0;   ///< share within the ellipsoid that should hold 99.73 %
  std::array<double, 6> axes{};  ///< share within 3 sigma: x y z (m), about x y z (rad)
  double median_sigmas = 0;      ///< median of the largest of the six |error| / sigma
};

/// Looks at the motion from each pose to the next (of the fused frames of a run). Its error, the
/// twist of (Q_i^-1 Q_j)^-1 (P_i^-1 P_j) with truth Q and estimate P, is held against the
/// covariance reported with the later pose j; that of the earlier one is not added, so an honest
/// covariance of single, independent poses would be found too small by a factor of sqrt(2). The
/// truth is that nearest in time, less than 0.02 s away; motions without, and those longer than
/// half a second, are left out. An ellipsoid without extent (a covariance of 0) holds nothing but
/// an error of 0. All 0 of no motion.
CovarianceShare checkCovariances(const Trajectory& truth, const std::vector<UncertainPose>& poses);

/// How far provisional poses (Reckoning) are to be trusted: of those with a truth nearby, the share
/// whose error is within 3 sigma on all six axes, and their errors.
struct ProvisionalShare {
  std::size_t poses = 0;
  double within = 0;
  double median_m = 0, most_m = 0;  ///< error of the position
  double median_sigma_m = 0;        ///< reported: the largest of the three axes
};

/// `known`: poses that are not provisional, which give the pose of the map in the truth.
ProvisionalShare checkProvisional(const Trajectory& truth, const Trajectory& known,
                                  const std::vector<UncertainPose>& provisional);

}  // namespace pf
