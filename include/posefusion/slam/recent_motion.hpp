// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/core/camera.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/tracking/result.hpp"

namespace pf {

/// The recent motion of the camera: the sum of its steps over about a second, in which older ones
/// fade.
class RecentMotion {
 public:
  /// From the frame before to this one.
  void add(const Eigen::Isometry3d& T_before_after, double elapsed_s);

  /// Part of the view of surfaces at `distance_m` that is new by this motion; more than 1 where
  /// whole views have passed.
  double newView(const PinholeCamera& camera, double distance_m) const;

  /// Covariance of an aligned pose against poses of the last second, half of it with either: what
  /// poses that see the same have in common is left out. One that was not aligned (distance 0)
  /// keeps its own.
  Matrix6d apart(const TrackingResult& tracking, const PinholeCamera& camera) const;

 private:
  Vector6d twist_ = Vector6d::Zero();  ///< m, rad, in the camera's frame
};

}  // namespace pf
