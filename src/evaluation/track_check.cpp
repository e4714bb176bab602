// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/track_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <utility>

#include "posefusion/core/se3.hpp"
#include "posefusion/core/stamps.hpp"

namespace pf {
namespace {

/// The estimated poses with the true ones of just their time.
std::vector<PosePair> pairWithTruth(const Trajectory& truth, const Trajectory& estimate) {
  std::vector<PosePair> pairs;
  for (const StampedPose& pose : estimate) {
    if (const auto T = poseAt(truth, pose.stamp_ns)) pairs.push_back({{pose.stamp_ns, *T}, pose});
  }
  return pairs;
}

double angleDeg(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return kDegreesPerRadian * logSo3(a.linear().transpose() * b.linear()).norm();
}

/// Whether the motion from one pair to another differs too much between truth and estimate.
bool movedWrongly(const PosePair& from, const PosePair& to) {
  const Eigen::Isometry3d truth = from.truth.T_world_camera.inverse() * to.truth.T_world_camera;
  const Eigen::Isometry3d estimate =
      from.estimate.T_world_camera.inverse() * to.estimate.T_world_camera;
  return (estimate.translation() - truth.translation()).norm() > kWrongDistance_m ||
         angleDeg(estimate, truth) > kWrongAngle_deg;
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
    const auto T = poseAt(truth, stamp_ns);
    if (!T) continue;
    pairs.push_back({{stamp_ns, *T}, estimate[i]});
    while (from + 1 < pairs.size() && stamp_ns - pairs[from + 1].estimate.stamp_ns >= kSecond_ns) {
      ++from;
    }
    if (movedWrongly(pairs[from], pairs.back())) wrong.push_back(i);
  }
  return wrong;
}

PlaceErrors placeErrors(const Trajectory& truth, const Trajectory& estimate) {
  const std::vector<PosePair> pairs = pairWithTruth(truth, estimate);
  std::vector<PosePair> first;
  for (const PosePair& pair : pairs) {
    if (pair.estimate.stamp_ns < pairs.front().estimate.stamp_ns + kSecond_ns) {
      first.push_back(pair);
    }
  }
  PlaceErrors errors;
  errors.T_truth_estimate = alignPoses(first);
  std::vector<double> distances;
  for (const PosePair& pair : pairs) {
    const Eigen::Isometry3d found = errors.T_truth_estimate * pair.estimate.T_world_camera;
    const Eigen::Isometry3d& wanted = pair.truth.T_world_camera;
    const double angle_deg = angleDeg(found, wanted);
    distances.push_back((found.translation() - wanted.translation()).norm());
    if (distances.back() > kWrongDistance_m || angle_deg > kWrongAngle_deg) ++errors.false_count;
    errors.worst_deg = std::max(errors.worst_deg, angle_deg);
  }
  errors.distance_m = statisticsOf(std::move(distances));
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
    const auto T = poseAt(truth, pose->stamp_ns);
    if (!T) continue;
    return (alignment * Eigen::Vector3d(pose->T_world_camera.translation()) - T->translation())
        .norm();
  }
  return 0.0;
}

}  // namespace pf
