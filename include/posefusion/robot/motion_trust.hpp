// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/robot/motion_prior.hpp"

namespace pf {

/// How far a motion sensor is believed, by its agreement with the images: a sequential test (Wald
/// 1945) of the hypothesis that it measures the camera's motion against the better of two others:
/// its output is unrelated to it, or is always zero motion. Without motion there is no evidence.
/// Translation and rotation are tested apart, and where both are measured both have to pass.
class MotionTrust {
 public:
  /// `covariance` (of the twist in the later camera's frame) is that of what was seen; it took
  /// `elapsed_s`.
  void compare(const MotionPrior& told, const Eigen::Isometry3d& T_seen, const Matrix6d& covariance,
               double elapsed_s);

  bool isBelieved() const;

  /// Its motions with the errors that they have shown.
  MotionPrior honest(MotionPrior told) const;

  /// From now on the sensor has to earn trust anew.
  void doubt();

 private:
  struct Half {
    double evidence = 0;  ///< log-likelihood ratio, within limits
    double spread = 1;    ///< of its errors: mean normalised square, at least 1

    /// `anything`: standard deviation of what a robot may do meanwhile.
    void compare(const Eigen::Vector3d& error, const Eigen::Vector3d& moved,
                 const Eigen::Matrix3d& told, const Eigen::Matrix3d& seen, double anything);
  };

  Half shift_, turn_;
  bool has_shift_ = false;
};

}  // namespace pf
