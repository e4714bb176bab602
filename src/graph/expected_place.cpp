// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/graph/expected_place.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/symmetric.hpp"
#include "posefusion/graph/drift.hpp"

namespace pf {
namespace {

// Error of the last pose before a loss, which is the worst there is: its covariance is that of an
// alignment that took wrong correspondences for right ones.
constexpr double kAtLoss_m = 0.15, kAtLoss_rad = 0.06;

}  // namespace

ExpectedPlace::ExpectedPlace(const PoseGraph& graph, const PoseConstraint& reckoned)
    : config_(graph.config()),
      covariance_(reckoned.covariance + independentCovariance(kAtLoss_m, kAtLoss_rad)) {
  const std::vector<Keyframe>& keyframes = graph.keyframes();
  const Keyframe& from = keyframes.at(static_cast<std::size_t>(reckoned.from));
  expected_ = {from.fragment, from.T_map_camera * reckoned.T_from_to};
  const std::vector<int> steps = Ways(keyframes.size(), graph.constraints()).stepsFrom(from.id);
  for (const Keyframe& k : keyframes) {
    if (k.fragment != from.fragment || k.isRetired()) continue;
    around_.push_back({k.T_map_camera.translation(), steps[static_cast<std::size_t>(k.id)]});
  }
}

double ExpectedPlace::chiSquare(const MapPose& found) const {
  if (found.fragment != expected_.fragment || around_.empty()) return 0;
  const Eigen::Isometry3d &T_found = found.T_map_camera, &T_expected = expected_.T_map_camera;
  const double off_m = (T_found.translation() - T_expected.translation()).norm();
  const int steps = mostStepsNear(T_found.translation(), 0.0);
  const Matrix6d covariance = covariance_ + driftCovariance(config_, steps, off_m);
  const Vector6d error = logSe3(T_expected.inverse() * T_found);
  return mahalanobis2(error, covariance);
}

bool ExpectedPlace::admitsNear(const MapPose& place, double reach_m) const {
  if (place.fragment != expected_.fragment || around_.empty()) return true;
  const Eigen::Vector3d position_m = place.T_map_camera.translation();
  const double off_m = (position_m - expected_.T_map_camera.translation()).norm();
  const int steps = mostStepsNear(position_m, reach_m);
  const Matrix6d covariance = covariance_ + driftCovariance(config_, steps, off_m + reach_m);
  // The shift of a twist is no shorter than that of its motion, and what is known of the rotation
  // only adds to the distance.
  const double most = eigenOf(covariance.topLeftCorner<3, 3>()).values[2];
  return off_m - reach_m <= std::sqrt(kMostChiSquare * most);
}

int ExpectedPlace::mostStepsNear(const Eigen::Vector3d& position_m, double reach_m) const {
  const auto far = [&](const Around& a) { return (a.position_m - position_m).norm(); };
  const Around& nearest =
      *std::min_element(around_.begin(), around_.end(),
                        [&](const Around& a, const Around& b) { return far(a) < far(b); });
  if (reach_m <= 0) return nearest.steps;
  const double most_m = far(nearest) + 2 * reach_m;
  int steps = 0;
  for (const Around& a : around_) {
    if (far(a) <= most_m) steps = std::max(steps, a.steps);
  }
  return steps;
}

}  // namespace pf
