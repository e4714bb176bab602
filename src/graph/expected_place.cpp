// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/graph/expected_place.hpp"

#include <Eigen/Cholesky>
#include <limits>

#include "posefusion/graph/drift.hpp"

namespace pf {
namespace {

// The last poses before a loss are the worst there are: they are told with the covariance of an
// alignment that believed the wrong things.
constexpr double kAtLoss_m = 0.15, kAtLoss_rad = 0.06;

/// The keyframe in use of the fragment that was nearest to the pose; -1: it has none.
int nearestTo(const MapPose& pose, const std::vector<Keyframe>& keyframes) {
  int nearest = -1;
  double least = std::numeric_limits<double>::max();
  for (const Keyframe& k : keyframes) {
    if (k.fragment != pose.fragment || k.isRetired()) continue;
    const double far =
        (k.T_map_camera.translation() - pose.T_map_camera.translation()).squaredNorm();
    if (far >= least) continue;
    least = far;
    nearest = k.id;
  }
  return nearest;
}

}  // namespace

ExpectedPlace::ExpectedPlace(const PoseGraph& graph, const PoseConstraint& reckoned)
    : config_(graph.config()),
      keyframes_(graph.keyframes()),
      covariance_(reckoned.covariance + independentCovariance(kAtLoss_m, kAtLoss_rad)) {
  const Keyframe& from = keyframes_.at(static_cast<std::size_t>(reckoned.from));
  expected_ = {from.fragment, from.T_map_camera * reckoned.T_from_to};
  steps_ = stepsFrom(from.id, keyframes_.size(), graph.constraints());
}

double ExpectedPlace::chiSquare(const MapPose& found) const {
  if (found.fragment != expected_.fragment) return 0;
  const Eigen::Isometry3d& T_expected = expected_.T_map_camera;
  const int near = nearestTo(found, keyframes_);
  if (near < 0) return 0;
  const double reach_m = (found.T_map_camera.translation() - T_expected.translation()).norm();
  const Matrix6d covariance =
      covariance_ + driftCovariance(config_, steps_[static_cast<std::size_t>(near)], reach_m);
  const Vector6d error = logSe3(T_expected.inverse() * found.T_map_camera);
  return error.dot(covariance.llt().solve(error));
}

}  // namespace pf
