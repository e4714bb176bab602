// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>

namespace pf {

/// The direction against gravity in a map, by what an inertial sensor felt while its place in the
/// map was known: a robot's own accelerations have no mean, as its speed is bounded.
class GravityEstimate {
 public:
  /// `felt_m_s2`: in the map frame, the mean of so long; at rest 9.81 upwards.
  void add(const Eigen::Vector3d& felt_m_s2, double elapsed_s);

  /// Unit vector; nothing in the first seconds.
  std::optional<Eigen::Vector3d> up() const;

 private:
  Eigen::Vector3d felt_m_s_ = Eigen::Vector3d::Zero();
  double elapsed_s_ = 0;
};

}  // namespace pf
