// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/evaluation/covariance_check.hpp"
#include "posefusion/graph/constraint.hpp"
#include "posefusion/graph/keyframe.hpp"

namespace pf {

/// x with P(chi-square of that many degrees of freedom <= x) = probability. `freedom` is even and
/// positive, 0 < probability < 1.
double chiSquareQuantile(int freedom, double probability);

/// Normalised estimation error squared of motions: how often its mean over a window lies within the
/// band that holds 95 % of the windows where errors are as large as reported, neither larger nor
/// smaller.
struct NeesShare {
  std::size_t motions = 0, windows = 0;
  double low = 0, high = 0;  ///< the band
  double mean = 0;           ///< of all motions; 6 where the covariance is the errors'
  double median = 0;         ///< the same; 5.35
  double inside = 0;         ///< share of the windows
  double too_low = 0;        ///< errors smaller than reported: too cautious
  double too_high = 0;       ///< larger: too sure
  /// Median |error| of an axis by what its sigma lets expect: x y z, about x y z. 1 is right, 2:
  /// the errors are twice as large as reported.
  std::array<double, 6> axes{};
};

/// Bar-Shalom, Li and Kirubarajan, "Estimation with Applications to Tracking and Navigation", 2001,
/// section 5.4.2. A motion goes from a pose i to the first one, j, a second or more later. With
/// truth Q and estimate P the twist of its error (Q_i^-1 Q_j)^-1 (P_i^-1 P_j) has the covariance
/// S_j + A S_i A^T, where A = adjoint(Q_j^-1 Q_i): as if errors of poses a second apart were
/// independent, for the correlation is not reported. A window has `per_window` motions one after
/// another that share no pose; there is one for each frame that it may begin with, so that the
/// shares are those of the run's time. The truth is interpolated. Motions over more than 1.2 s, and
/// those without a truth within 0.02 s, break a window. A covariance without extent holds no error.
NeesShare neesOfMotions(const Trajectory& truth, const std::vector<UncertainPose>& poses,
                        std::size_t per_window);

/// The same of constraints between keyframes, each a window of its own: the twist of the error
/// (Q_i^-1 Q_j)^-1 T_from_to has the constraint's covariance. Those between keyframes without a
/// truth within 0.02 s are left out. Constraints must be between the keyframes given.
NeesShare neesOfConstraints(const Trajectory& truth, const std::vector<Keyframe>& keyframes,
                            const std::vector<PoseConstraint>& constraints);

}  // namespace pf
