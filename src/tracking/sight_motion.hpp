// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "posefusion/core/camera.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/tracking/sparse_motion.hpp"

namespace pf {

/// Where a corner is in space, and where the later frame sees it.
struct Sight {
  Eigen::Vector3d before;  ///< m, in the earlier camera's frame
  Eigen::Vector2d after_px;
  double spread = 1.0;       ///< standard deviation of that, over a corner's apart from people
  double after_m = 0;        ///< depth in the later frame, 0 = not known
  double after_sigma_m = 0;  ///< of that depth
  /// Where it has no depth of its own: half the inverse depth (1/m) of what is beside it, and
  /// `before` is its ray; else 0.
  double far_inverse = 0;

  bool hasDepth() const { return far_inverse == 0; }
};

/// The motion by which sights agree best.
struct SightMotion {
  Eigen::Isometry3d T_after_before = Eigen::Isometry3d::Identity();
  /// Corners without depth are at so much of Sight::far_inverse: 0, infinitely far, to 2, as far as
  /// what is beside them. All alike, as the holes of a picture are mostly one.
  double far = 1.0;
  Matrix6d covariance = Matrix6d::Zero();  ///< of the twist of T_after_before
  int inliers = 0;
  double squared_px = 0;  ///< reprojection, summed over the inliers
  /// Minus log-likelihood of the sights and of what was expected, up to a constant.
  double cost = 0;
};

/// Least squares over reprojection and inverse depth with Cauchy's weights and over what is
/// expected, from a first guess; false when it leads nowhere. The covariance grows with the
/// residuals.
bool fitMotion(const std::vector<Sight>& sights, const PinholeCamera& camera,
               const std::optional<ExpectedStep>& expected, SightMotion& motion);

}  // namespace pf
