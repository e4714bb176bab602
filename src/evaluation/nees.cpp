// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/nees.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "posefusion/core/symmetric.hpp"
#include "posefusion/evaluation/metrics.hpp"

namespace pf {
namespace {

constexpr std::int64_t kMotion_ns = 1'000'000'000;
constexpr std::int64_t kLongestMotion_ns = 1'200'000'000;
/// Half of all normal errors are within so many standard deviations.
constexpr double kMedianOfNormal = 0.67449;
constexpr double kOutside = 0.025;  ///< on either side

struct KnownPose {
  UncertainPose estimate;
  Eigen::Isometry3d T_world_camera;  ///< the truth
};

std::vector<KnownPose> withTruth(const Trajectory& truth, const std::vector<UncertainPose>& poses) {
  std::vector<KnownPose> known;
  for (const UncertainPose& pose : poses) {
    if (const auto T = poseAt(truth, pose.stamp_ns)) known.push_back({pose, *T});
  }
  return known;
}

struct MotionError {
  double nees = 0.0;
  Vector6d sigmas = Vector6d::Zero();  ///< |error| of each axis
};

MotionError normalised(const Vector6d& error, const Matrix6d& covariance) {
  if (!isPositiveDefinite(covariance)) {
    const double all = error.isZero(0.0) ? 0.0 : std::numeric_limits<double>::infinity();
    return {all, Vector6d::Constant(all)};
  }
  return {mahalanobis2(error, covariance),
          error.cwiseAbs().cwiseQuotient(covariance.diagonal().cwiseSqrt())};
}

MotionError errorOf(const KnownPose& from, const KnownPose& to) {
  const Eigen::Isometry3d T_to_from = to.T_world_camera.inverse() * from.T_world_camera;
  const Vector6d error =
      logSe3(T_to_from * from.estimate.T_map_camera.inverse() * to.estimate.T_map_camera);
  const Matrix6d A = adjoint(T_to_from);
  return normalised(error, to.estimate.covariance + propagated(A, from.estimate.covariance));
}

/// Where the motion from each pose ends; nothing where there is no pose in time.
std::vector<std::optional<std::size_t>> endsOf(const std::vector<KnownPose>& poses) {
  std::vector<std::optional<std::size_t>> ends(poses.size());
  std::size_t end = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::int64_t begin_ns = poses[i].estimate.stamp_ns;
    while (end < poses.size() && poses[end].estimate.stamp_ns - begin_ns < kMotion_ns) ++end;
    if (end == poses.size()) break;
    if (poses[end].estimate.stamp_ns - begin_ns <= kLongestMotion_ns) ends[i] = end;
  }
  return ends;
}

/// Mean of the window that begins with a pose; nothing where one of its motions is missing.
std::optional<double> windowMean(const std::vector<std::optional<std::size_t>>& ends,
                                 const std::vector<MotionError>& errors, std::size_t begin,
                                 std::size_t per_window) {
  double sum = 0.0;
  for (std::size_t n = 0; n < per_window; ++n) {
    if (begin >= ends.size() || !ends[begin]) return std::nullopt;
    sum += errors[begin].nees;
    begin = *ends[begin] + 1;
  }
  return sum / static_cast<double>(per_window);
}

/// What all motions have in common, whatever their windows.
void describe(const std::vector<MotionError>& errors, NeesShare& share) {
  std::vector<double> nees;
  std::array<std::vector<double>, 6> axes;
  for (const MotionError& error : errors) {
    nees.push_back(error.nees);
    for (int axis = 0; axis < 6; ++axis) {
      axes[static_cast<std::size_t>(axis)].push_back(error.sigmas[axis]);
    }
  }
  const ErrorStatistics all = statisticsOf(std::move(nees));
  share.motions = all.count;
  share.mean = all.mean;
  share.median = all.median;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    share.axes[axis] = statisticsOf(std::move(axes[axis])).median / kMedianOfNormal;
  }
}

/// How many of the windows' means lie where.
void count(const std::vector<double>& means, std::size_t per_window, NeesShare& share) {
  const auto n = static_cast<double>(per_window);
  share.low = chiSquareQuantile(6 * static_cast<int>(per_window), kOutside) / n;
  share.high = chiSquareQuantile(6 * static_cast<int>(per_window), 1.0 - kOutside) / n;
  share.windows = means.size();
  if (means.empty()) return;
  const auto windows = static_cast<double>(means.size());
  const auto low =
      std::count_if(means.begin(), means.end(), [&](double m) { return m < share.low; });
  const auto high =
      std::count_if(means.begin(), means.end(), [&](double m) { return m > share.high; });
  share.too_low = static_cast<double>(low) / windows;
  share.too_high = static_cast<double>(high) / windows;
  share.inside = 1.0 - share.too_low - share.too_high;
}

}  // namespace

double chiSquareQuantile(int freedom, double probability) {
  // Of an even number of degrees: 1 - exp(-x / 2) sum (x / 2)^i / i!, i < freedom / 2.
  const auto below = [&](double x) {
    double term = std::exp(-0.5 * x), sum = term;
    for (int i = 1; i < freedom / 2; ++i) sum += term *= 0.5 * x / i;
    return 1.0 - sum;
  };
  double low = 0.0, high = 10.0 * freedom + 100.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (below(middle) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

NeesShare neesOfMotions(const Trajectory& truth, const std::vector<UncertainPose>& poses,
                        std::size_t per_window) {
  const std::vector<KnownPose> known = withTruth(truth, poses);
  const auto ends = endsOf(known);
  std::vector<MotionError> errors(known.size());
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (ends[i]) errors[i] = errorOf(known[i], known[*ends[i]]);
  }
  std::vector<MotionError> complete;
  std::vector<double> means;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (ends[i]) complete.push_back(errors[i]);
    if (const auto mean = windowMean(ends, errors, i, per_window)) means.push_back(*mean);
  }
  NeesShare share;
  describe(complete, share);
  count(means, per_window, share);
  return share;
}

NeesShare neesOfConstraints(const Trajectory& truth, const std::vector<Keyframe>& keyframes,
                            const std::vector<PoseConstraint>& constraints) {
  std::vector<MotionError> errors;
  std::vector<double> nees;
  for (const PoseConstraint& c : constraints) {
    const auto from = poseAt(truth, keyframes.at(static_cast<std::size_t>(c.from)).stamp_ns);
    const auto to = poseAt(truth, keyframes.at(static_cast<std::size_t>(c.to)).stamp_ns);
    if (!from || !to) continue;
    errors.push_back(normalised(logSe3(to->inverse() * *from * c.T_from_to), c.covariance));
    nees.push_back(errors.back().nees);
  }
  NeesShare share;
  describe(errors, share);
  count(nees, 1, share);
  return share;
}

}  // namespace pf
