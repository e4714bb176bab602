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

}  // namespace pf
