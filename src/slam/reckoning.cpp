// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/reckoning.hpp"

#include <algorithm>

#include "posefusion/core/symmetric.hpp"
#include "posefusion/robot/motion_prior.hpp"

namespace pf {
namespace {

// Beyond it the camera may look anywhere.
constexpr double kAnyAngle_rad = 1.8;
// What is systematic in the steps: the scale of depth, and corners that lie on what moves.
constexpr double kOfWay = 0.05, kOfTurn = 0.03, kTurnOfWay_rad_m = 0.02;

// A camera is carried by what moves with all that it sees so seldom that on the mean it does this.
// Whatever it was lost by, after some minutes it may be anywhere.
constexpr double kCarried_m_s = 0.005, kCarried_rad_s = 0.003;

Matrix6d gap(double elapsed_s) {
  return independentCovariance(kRobotSpeed_m_s * elapsed_s,
                               std::min(kRobotTurn_rad_s * elapsed_s, kAnyAngle_rad));
}

}  // namespace

void Reckoning::know(const Eigen::Isometry3d& T_map_camera, const Matrix6d& covariance) {
  is_known_ = true;
  T_map_camera_ = T_map_camera;
  steps_ = covariance;
  way_m_ = turn_rad_ = blind_s_ = elapsed_s_ = 0;
}

void Reckoning::move(const Eigen::Isometry3d& T_before_after, const Matrix6d& covariance,
                     double elapsed_s) {
  T_map_camera_ = orthonormalised(T_map_camera_ * T_before_after);
  if (blind_s_ > 0) steps_ += gap(blind_s_);
  blind_s_ = 0;
  const Matrix6d A = adjoint(T_before_after.inverse());
  steps_ = propagated(A, steps_) + covariance;
  way_m_ += T_before_after.translation().norm();
  turn_rad_ += angleOf(T_before_after);
  elapsed_s_ += elapsed_s;
}

void Reckoning::pass(double elapsed_s) {
  blind_s_ += elapsed_s;
  elapsed_s_ += elapsed_s;
}

void Reckoning::correct(const Eigen::Isometry3d& T_new_old) {
  T_map_camera_ = T_new_old * T_map_camera_;
}

std::optional<ProvisionalPose> Reckoning::pose() const {
  if (!is_known_) return std::nullopt;
  ProvisionalPose pose;
  pose.T_map_camera = T_map_camera_;
  pose.covariance =
      steps_ +
      independentCovariance(kOfWay * way_m_, kOfTurn * turn_rad_ + kTurnOfWay_rad_m * way_m_) +
      independentCovariance(kCarried_m_s * elapsed_s_,
                            std::min(kCarried_rad_s * elapsed_s_, kAnyAngle_rad));
  if (blind_s_ > 0) pose.covariance += gap(blind_s_);
  return pose;
}

}  // namespace pf
