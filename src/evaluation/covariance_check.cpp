// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/covariance_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "posefusion/core/symmetric.hpp"
#include "posefusion/evaluation/metrics.hpp"

namespace pf {
namespace {

constexpr std::int64_t kLongestStep_ns = 500'000'000;
/// 99.73 % of six independent normal variables lie within (chi-squared, 6 degrees of freedom).
constexpr double kEllipsoid = 20.062;

/// Error of the motion between two poses, in the camera frame of the later one.
Vector6d motionError(const PosePair& from, const PosePair& to) {
  const Eigen::Isometry3d truth = from.truth.T_world_camera.inverse() * to.truth.T_world_camera;
  const Eigen::Isometry3d estimate =
      from.estimate.T_world_camera.inverse() * to.estimate.T_world_camera;
  return logSe3(truth.inverse() * estimate);
}

double sigmasOf(double error, double variance) {
  if (error == 0.0) return 0.0;
  return variance > 0.0 ? std::abs(error) / std::sqrt(variance)
                        : std::numeric_limits<double>::infinity();
}

bool isInEllipsoid(const Vector6d& error, const Matrix6d& covariance) {
  if (!isPositiveDefinite(covariance)) return error.isZero(0.0);
  return mahalanobis2(error, covariance) <= kEllipsoid;
}

}  // namespace

CovarianceShare checkCovariances(const Trajectory& truth, const std::vector<UncertainPose>& poses) {
  Trajectory estimate;
  for (const UncertainPose& pose : poses) estimate.push_back({pose.stamp_ns, pose.T_map_camera});
  const std::vector<PosePair> pairs = matchPoses(truth, estimate);
  CovarianceShare share;
  std::vector<double> largest;
  for (std::size_t i = 1, at = 0; i < pairs.size(); ++i) {
    const std::int64_t stamp_ns = pairs[i].estimate.stamp_ns;
    while (poses[at].stamp_ns < stamp_ns) ++at;
    if (stamp_ns - pairs[i - 1].estimate.stamp_ns > kLongestStep_ns) continue;
    const Vector6d error = motionError(pairs[i - 1], pairs[i]);
    const Matrix6d& covariance = poses[at].covariance;
    largest.push_back(0.0);
    for (int axis = 0; axis < 6; ++axis) {
      const double sigmas = sigmasOf(error[axis], covariance(axis, axis));
      largest.back() = std::max(largest.back(), sigmas);
      if (sigmas <= 3.0) share.axes[static_cast<std::size_t>(axis)] += 1.0;
    }
    if (largest.back() <= 3.0) share.within += 1.0;
    if (isInEllipsoid(error, covariance)) share.within_ellipsoid += 1.0;
  }
  share.motions = largest.size();
  if (largest.empty()) return share;
  const auto n = static_cast<double>(largest.size());
  for (double& axis : share.axes) axis /= n;
  share.within /= n;
  share.within_ellipsoid /= n;
  share.median_sigmas = statisticsOf(largest).median;
  return share;
}

ProvisionalShare checkProvisional(const Trajectory& truth, const Trajectory& known,
                                  const std::vector<UncertainPose>& provisional) {
  Trajectory estimate;
  for (const UncertainPose& pose : provisional) {
    estimate.push_back({pose.stamp_ns, pose.T_map_camera});
  }
  const std::vector<PosePair> pairs = matchPoses(truth, estimate);
  const auto places = matchPoses(truth, known);
  ProvisionalShare share;
  if (pairs.empty() || places.size() < 3) return share;
  const Alignment to_truth = align(places, false);
  std::vector<double> errors_m, sigmas_m;
  std::size_t within = 0, at = 0;
  for (const PosePair& pair : pairs) {
    while (provisional[at].stamp_ns < pair.estimate.stamp_ns) ++at;
    const Matrix6d& covariance = provisional[at].covariance;
    const Vector6d error =
        logSe3((to_truth * pair.estimate.T_world_camera).inverse() * pair.truth.T_world_camera);
    bool is_within = true;
    for (int axis = 0; axis < 6; ++axis) {
      is_within = is_within && sigmasOf(error[axis], covariance(axis, axis)) <= 3.0;
    }
    within += is_within ? 1 : 0;
    errors_m.push_back(error.head<3>().norm());
    sigmas_m.push_back(std::sqrt(covariance.diagonal().head<3>().maxCoeff()));
  }
  share.poses = pairs.size();
  share.within = static_cast<double>(within) / static_cast<double>(share.poses);
  share.median_m = statisticsOf(errors_m).median;
  share.most_m = *std::max_element(errors_m.begin(), errors_m.end());
  share.median_sigma_m = statisticsOf(sigmas_m).median;
  return share;
}

}  // namespace pf
