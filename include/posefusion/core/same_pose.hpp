// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/core/se3.hpp"

namespace pf {

/// How far apart two poses of one camera may be to count as one.
struct PoseTolerance {
  double shift_m, turn_rad;
};

/// Two alignments, or an alignment and what is expected of it, have found one pose: good ones
/// differ by a centimetre or two.
constexpr PoseTolerance kSamePose{0.03, 0.03};

/// Two searches have found one place: aligning once more leads from one to the other.
constexpr PoseTolerance kSamePlace{0.10, 0.10};

/// Does the motion from one to the other stay within the tolerance?
inline bool isWithin(const Eigen::Isometry3d& T, const PoseTolerance& tolerance) {
  return isWithin(T, tolerance.shift_m, tolerance.turn_rad);
}

/// Covariance of a pose known to within the tolerance, as a standard deviation.
inline Matrix6d covarianceOf(const PoseTolerance& tolerance) {
  return independentCovariance(tolerance.shift_m, tolerance.turn_rad);
}

}  // namespace pf
