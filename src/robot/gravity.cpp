// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/robot/gravity.hpp"

namespace pf {
namespace {

// A speed of 0.5 m/s gained in so long tilts the mean by half a degree.
constexpr double kLeast_s = 6.0;
constexpr double kGravity_m_s2 = 9.81, kMostOff_m_s2 = 1.0;

}  // namespace

void GravityEstimate::add(const Eigen::Vector3d& felt_m_s2, double elapsed_s) {
  felt_m_s_ += elapsed_s * felt_m_s2;
  elapsed_s_ += elapsed_s;
}

std::optional<Eigen::Vector3d> GravityEstimate::up() const {
  if (elapsed_s_ < kLeast_s) return std::nullopt;
  const Eigen::Vector3d mean = felt_m_s_ / elapsed_s_;
  // Else it is no accelerometer, in other units, or mounted otherwise than it is said to be.
  if (!(std::abs(mean.norm() - kGravity_m_s2) < kMostOff_m_s2)) return std::nullopt;
  return mean.normalized();
}

Eigen::Isometry3d levelFromMap(const Eigen::Vector3d& up_in_map) {
  const Eigen::Vector3d z = up_in_map.normalized();
  Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ() - z.z() * z;
  // Looking straight up or down: the top of the picture is ahead.
  if (ahead.norm() < 0.1) ahead = -Eigen::Vector3d::UnitY() + z.y() * z;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear().row(0) = ahead.normalized();
  T.linear().row(2) = z;
  T.linear().row(1) = z.cross(ahead.normalized());
  return T;
}

}  // namespace pf
