// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/recent_motion.hpp"

#include <algorithm>
#include <cmath>

namespace pf {
namespace {

constexpr double kRecent_s = 1.0;
constexpr double kNearest_m = 0.3;
// Part of a pose's variance that two poses do not share where both see the same: noise that is new
// in every frame. As measured while the camera stood.
constexpr double kApartAtRest = 0.08;

}  // namespace

void RecentMotion::add(const Eigen::Isometry3d& T_before_after, double elapsed_s) {
  const double left = std::exp(-std::max(0.0, elapsed_s) / kRecent_s);
  twist_ = left * adjoint(T_before_after.inverse()) * twist_ + logSe3(T_before_after);
}

double RecentMotion::newView(const PinholeCamera& camera, double distance_m) const {
  // All is new when it has moved by its shorter side.
  const double view_rad =
      2.0 * std::atan(0.5 * std::min(camera.width / camera.fx, camera.height / camera.fy));
  const double shift_rad = twist_.head<3>().norm() / std::max(kNearest_m, distance_m);
  return (twist_.tail<3>().norm() + shift_rad) / view_rad;
}

Matrix6d RecentMotion::apart(const TrackingResult& tracking, const PinholeCamera& camera) const {
  if (tracking.distance_m <= 0) return tracking.covariance;
  const double part = kApartAtRest + newView(camera, tracking.distance_m);
  return part * (tracking.covariance + tracking.systematic);
}

}  // namespace pf
