// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/metrics.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <optional>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/core/stamps.hpp"

namespace pf {
namespace {

constexpr std::int64_t kMaxTruthDifference_ns = 20'000'000;

/// Index of the pose nearest in time; the trajectory is sorted and not empty.
std::size_t nearest(const Trajectory& trajectory, std::int64_t stamp_ns) {
  const auto after =
      std::lower_bound(trajectory.begin(), trajectory.end(), stamp_ns,
                       [](const StampedPose& p, std::int64_t stamp) { return p.stamp_ns < stamp; });
  if (after == trajectory.begin()) return 0;
  const auto before = std::prev(after);
  const bool take_before =
      after == trajectory.end() || stamp_ns - before->stamp_ns <= after->stamp_ns - stamp_ns;
  return static_cast<std::size_t>((take_before ? before : after) - trajectory.begin());
}

std::optional<Eigen::Isometry3d> nearestTruth(const Trajectory& truth, std::int64_t stamp_ns) {
  const StampedPose& pose = truth[nearest(truth, stamp_ns)];
  if (std::llabs(pose.stamp_ns - stamp_ns) > kMaxTruthDifference_ns) return std::nullopt;
  return pose.T_world_camera;
}

/// `next(i)` is the index of the estimated pose that pose i is compared with.
template <typename Next>
RelativeError relativeError(const Trajectory& truth, const Trajectory& estimate, double scale,
                            const Next& next) {
  std::vector<double> translations, rotations;
  for (std::size_t i = 0; !truth.empty() && i < estimate.size(); ++i) {
    const std::size_t j = next(i);
    // The last pose is nearest to every time after the end: TUM's tool leaves it out.
    if (j <= i || j + 1 >= estimate.size()) continue;
    const auto truth_i = nearestTruth(truth, estimate[i].stamp_ns);
    const auto truth_j = nearestTruth(truth, estimate[j].stamp_ns);
    if (!truth_i || !truth_j) continue;
    Eigen::Isometry3d moved = estimate[i].T_world_camera.inverse() * estimate[j].T_world_camera;
    moved.translation() *= scale;
    const Eigen::Isometry3d error = (truth_i->inverse() * *truth_j).inverse() * moved;
    translations.push_back(error.translation().norm());
    rotations.push_back(logSo3(error.linear()).norm() * kDegreesPerRadian);
  }
  return {statisticsOf(translations), statisticsOf(rotations)};
}

}  // namespace

ErrorStatistics statisticsOf(std::vector<double> errors) {
  ErrorStatistics s;
  s.count = errors.size();
  if (errors.empty()) return s;
  std::sort(errors.begin(), errors.end());
  const auto n = static_cast<double>(errors.size());
  s.squares_sum = std::inner_product(errors.begin(), errors.end(), errors.begin(), 0.0);
  s.rmse = std::sqrt(s.squares_sum / n);
  s.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / n;
  s.median = 0.5 * (errors[(errors.size() - 1) / 2] + errors[errors.size() / 2]);
  s.min = errors.front();
  s.max = errors.back();
  double spread = 0;
  for (const double error : errors) spread += (error - s.mean) * (error - s.mean);
  s.deviation = std::sqrt(spread / n);
  return s;
}

std::vector<PosePair> matchPoses(const Trajectory& truth, const Trajectory& estimate,
                                 std::int64_t max_difference_ns) {
  std::vector<std::int64_t> true_stamps, estimated_stamps;
  for (const auto& pose : truth) true_stamps.push_back(pose.stamp_ns);
  for (const auto& pose : estimate) estimated_stamps.push_back(pose.stamp_ns);
  std::vector<PosePair> pairs;
  for (const auto& [i, j] : matchStamps(true_stamps, estimated_stamps, max_difference_ns)) {
    pairs.push_back({truth[i], estimate[j]});
  }
  return pairs;
}

Eigen::Isometry3d Alignment::operator*(const Eigen::Isometry3d& pose) const {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = rotation * pose.linear();
  out.translation() = *this * Eigen::Vector3d(pose.translation());
  return out;
}

Alignment align(const std::vector<PosePair>& pairs, bool with_scale) {
  if (pairs.size() < 3) {
    throw InputError("only " + std::to_string(pairs.size()) +
                     " estimated poses have a true one within 0.02 s, expected 3 or more");
  }
  Eigen::Matrix3Xd truth(3, pairs.size()), estimate(3, pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    truth.col(column) = pairs[i].truth.T_world_camera.translation();
    estimate.col(column) = pairs[i].estimate.T_world_camera.translation();
  }
  const Eigen::Matrix4d T = Eigen::umeyama(estimate, truth, with_scale);
  Alignment alignment;
  alignment.scale = with_scale ? T.block<3, 1>(0, 0).norm() : 1.0;
  alignment.rotation = T.topLeftCorner<3, 3>() / alignment.scale;
  alignment.translation = T.topRightCorner<3, 1>();
  if (!T.allFinite()) throw InputError("the estimated poses do not move: no scale can be found");
  return alignment;
}

Eigen::Isometry3d alignPoses(const std::vector<PosePair>& pairs) {
  if (pairs.empty()) throw InputError("no estimated pose has a true one within 0.02 s");
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const auto& [truth, estimate] : pairs) {
    sum += truth.T_world_camera.linear() * estimate.T_world_camera.linear().transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d V = svd.matrixV();
  Eigen::Matrix3d U = svd.matrixU();
  if ((U * V.transpose()).determinant() < 0) U.col(2) = -U.col(2);
  Eigen::Isometry3d T_truth_estimate = Eigen::Isometry3d::Identity();
  T_truth_estimate.linear() = U * V.transpose();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (const auto& [truth, estimate] : pairs) {
    shift += truth.T_world_camera.translation() -
             T_truth_estimate.linear() * estimate.T_world_camera.translation();
  }
  T_truth_estimate.translation() = shift / static_cast<double>(pairs.size());
  return T_truth_estimate;
}

ErrorStatistics absoluteError(const std::vector<PosePair>& pairs, const Alignment& alignment) {
  std::vector<double> errors;
  for (const auto& [truth, estimate] : pairs) {
    const Eigen::Vector3d position = estimate.T_world_camera.translation();
    errors.push_back((alignment * position - truth.T_world_camera.translation()).norm());
  }
  return statisticsOf(std::move(errors));
}

RelativeError relativeErrorPerFrame(const Trajectory& truth, const Trajectory& estimate,
                                    double scale) {
  return relativeError(truth, estimate, scale, [](std::size_t i) { return i + 1; });
}

RelativeError relativeErrorPerSecond(const Trajectory& truth, const Trajectory& estimate,
                                     double scale) {
  return relativeError(truth, estimate, scale, [&](std::size_t i) {
    return nearest(estimate, estimate[i].stamp_ns + kSecond_ns);
  });
}

}  // namespace pf
