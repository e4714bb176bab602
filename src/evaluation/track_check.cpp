// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/track_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>

#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kAligned_ns = 5 * kSecond_ns;
constexpr double kDegrees = 180.0 / M_PI;

/// The estimated poses with the true ones of just their time.
std::vector<PosePair> pairWithTruth(const Trajectory& truth, const Trajectory& estimate) {
  std::vector<PosePair> pairs;
  for (const StampedPose& pose : estimate) {
    if (const auto T = truePoseAt(truth, pose.stamp_ns))
      pairs.push_back({{pose.stamp_ns, *T}, pose});
  }
  return pairs;
}

double distance(const PosePair& pair, const Eigen::Vector3d& estimate) {
  return (estimate - pair.truth.T_world_camera.translation()).norm();
}

/// Whether the motion from one pair to another differs too much between truth and estimate.
bool movedWrongly(const PosePair& from, const PosePair& to) {
  const Eigen::Isometry3d truth = from.truth.T_world_camera.inverse() * to.truth.T_world_camera;
  const Eigen::Isometry3d estimate =
      from.estimate.T_world_camera.inverse() * to.estimate.T_world_camera;
  const double angle_rad = logSo3(estimate.linear().transpose() * truth.linear()).norm();
  return (estimate.translation() - truth.translation()).norm() > kWrongDistance_m ||
         angle_rad * kDegrees > kWrongAngle_deg;
}

double shareOf(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 1.0;
}

}  // namespace

double PoseCoverage::share() const { return shareOf(posed, frames); }
double PoseCoverage::sharpShare() const { return shareOf(sharp_posed, sharp_frames); }

PoseCoverage coverageOf(const Trajectory& estimate, const TrackFacts& facts) {
  std::vector<std::int64_t> posed_ns;
  for (const StampedPose& pose : estimate) posed_ns.push_back(pose.stamp_ns);
  PoseCoverage coverage;
  for (const std::int64_t stamp : facts.frames_ns) {
    const bool posed = std::binary_search(posed_ns.begin(), posed_ns.end(), stamp);
    const bool blurred =
        std::binary_search(facts.blurred_ns.begin(), facts.blurred_ns.end(), stamp);
    ++coverage.frames;
    if (posed) ++coverage.posed;
    if (blurred) continue;
    ++coverage.sharp_frames;
    if (posed) ++coverage.sharp_posed;
  }
  return coverage;
}

std::vector<std::size_t> wrongPoses(const Trajectory& truth, const Trajectory& estimate) {
  std::vector<PosePair> pairs;
  std::vector<std::size_t> wrong;
  std::size_t from = 0;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const std::int64_t stamp_ns = estimate[i].stamp_ns;
    const auto T = truePoseAt(truth, stamp_ns);
    if (!T) continue;
    pairs.push_back({{stamp_ns, *T}, estimate[i]});
    while (from + 1 < pairs.size() && stamp_ns - pairs[from + 1].estimate.stamp_ns >= kSecond_ns) {
      ++from;
    }
    if (movedWrongly(pairs[from], pairs.back())) wrong.push_back(i);
  }
  return wrong;
}

PlaceErrors placeErrors(const Trajectory& truth, const Trajectory& estimate,
                        const TrackFacts& facts) {
  const std::vector<PosePair> pairs = pairWithTruth(truth, estimate);
  std::vector<PosePair> first;
  const auto takeBefore = [&](std::int64_t end_ns) {
    for (const PosePair& pair : pairs) {
      if (pair.estimate.stamp_ns < end_ns) first.push_back(pair);
    }
  };
  if (facts.first_fall_ns) takeBefore(*facts.first_fall_ns);
  if (first.empty() && !pairs.empty()) takeBefore(pairs.front().estimate.stamp_ns + kAligned_ns);
  PlaceErrors errors;
  errors.T_truth_estimate = alignPoses(first);
  errors.count = pairs.size();
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d position = pair.estimate.T_world_camera.translation();
    const double error_m = distance(pair, errors.T_truth_estimate * position);
    if (error_m > kWrongDistance_m) ++errors.false_count;
    errors.worst_m = std::max(errors.worst_m, error_m);
  }
  return errors;
}

ErrorStatistics heldError(const Trajectory& truth, const Trajectory& estimate,
                          const std::vector<std::int64_t>& frames_ns, const Alignment& alignment) {
  Trajectory held;
  std::size_t next = 0;
  for (const std::int64_t stamp_ns : frames_ns) {
    while (next < estimate.size() && estimate[next].stamp_ns <= stamp_ns) ++next;
    if (next > 0) held.push_back({stamp_ns, estimate[next - 1].T_world_camera});
  }
  return absoluteError(pairWithTruth(truth, held), alignment);
}

double lastError(const Trajectory& truth, const Trajectory& estimate, const Alignment& alignment) {
  for (auto pose = estimate.rbegin(); pose != estimate.rend(); ++pose) {
    const auto T = truePoseAt(truth, pose->stamp_ns);
    if (!T) continue;
    return (alignment * Eigen::Vector3d(pose->T_world_camera.translation()) - T->translation())
        .norm();
  }
  return 0.0;
}

}  // namespace pf
