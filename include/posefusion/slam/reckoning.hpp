// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "posefusion/core/se3.hpp"

namespace pf {

/// A pose by dead reckoning, for a camera that is not located.
struct ProvisionalPose {
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();  ///< in the first fragment
  Matrix6d covariance = Matrix6d::Zero();  ///< of the twist (m, rad) in the camera frame
};

/// Dead reckoning from the last known pose in the first fragment of the map on: by corners, by
/// tracking in a fragment whose place is not known, or by nothing but how fast a robot moves. Four
/// errors add up: those of the single steps; what is systematic in them, which grows with the way;
/// what may have happened while nothing measured the motion; and what no step shows (a lift, a
/// trolley), both of which grow with the time. Not thread safe.
class Reckoning {
 public:
  /// The camera is at this known pose.
  void know(const Eigen::Isometry3d& T_map_camera, const Matrix6d& covariance);

  /// The camera has moved in `elapsed_s`. `covariance`: of the step's twist, in the camera frame
  /// after it.
  void move(const Eigen::Isometry3d& T_before_after, const Matrix6d& covariance, double elapsed_s);

  /// For `elapsed_s` nothing has measured the motion.
  void pass(double elapsed_s);

  /// The map has been corrected: what was at a pose T is now at T_new_old * T.
  void correct(const Eigen::Isometry3d& T_new_old);

  void reset() { *this = Reckoning(); }

  /// Nothing before the camera was first known.
  std::optional<ProvisionalPose> pose() const;

 private:
  bool is_known_ = false;
  Eigen::Isometry3d T_map_camera_ = Eigen::Isometry3d::Identity();
  Matrix6d steps_ = Matrix6d::Zero();  ///< covariance of the single steps, and of past gaps
  double way_m_ = 0, turn_rad_ = 0;    ///< since it was known
  double blind_s_ = 0;                 ///< since the motion was last measured
  double elapsed_s_ = 0;               ///< since it was known
};

}  // namespace pf
