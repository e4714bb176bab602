// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/worker.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/stopwatch.hpp"

namespace pf {
namespace {

// Where no floor was mapped, the camera's own idea of up has to do.
constexpr double kUpright_rad = 0.7;
// Lower or more tilted than this the last pose is not one that the camera stands in.
constexpr double kStandingHeight_m = 0.2, kStandingTilt_rad = 0.2;
// Candidates that are verified; the same place may come from several searches.
constexpr std::size_t kVerified = 6, kVerifiedElsewhere = 12;

/// Up in the map, by how the camera was held at its keyframes: the last pose may be of a fall.
Eigen::Vector3d meanUpright(const std::vector<Eigen::Isometry3d>& keyframes,
                            const Eigen::Isometry3d& T_map_last) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Isometry3d& T : keyframes) sum -= T.linear().col(1);
  if (sum.norm() < 0.5 * static_cast<double>(keyframes.size())) sum.setZero();  // held anyhow
  return sum.isZero() ? Eigen::Vector3d(-T_map_last.linear().col(1)) : sum.normalized();
}

/// Where the camera would stand at the place of its last pose, as it does at the nearest keyframe.
/// Nothing where it stands already.
std::optional<Eigen::Isometry3d> standing(const std::vector<Eigen::Isometry3d>& keyframes,
                                          const Eigen::Isometry3d& T_map_last,
                                          const Eigen::Vector3d& up) {
  const auto far = [&](const Eigen::Isometry3d& T) {
    return (T.translation() - T_map_last.translation()).squaredNorm();
  };
  const auto nearest =
      std::min_element(keyframes.begin(), keyframes.end(),
                       [&](const auto& a, const auto& b) { return far(a) < far(b); });
  if (nearest == keyframes.end()) return std::nullopt;
  const double higher_m = up.dot(nearest->translation() - T_map_last.translation());
  const Eigen::Vector3d a = nearest->linear().transpose() * up;
  const Eigen::Vector3d b = T_map_last.linear().transpose() * up;
  if (std::abs(higher_m) < kStandingHeight_m && a.dot(b) > std::cos(kStandingTilt_rad)) {
    return std::nullopt;
  }
  Eigen::Isometry3d T = *nearest;
  T.translation() = T_map_last.translation() + higher_m * up;
  return T;
}

}  // namespace

LoopWorker::LoopWorker(const LoopConfig& config, const TrackingConfig& tracking)
    : config_(config), tracking_(tracking), closer_(config, tracking), verifier_(tracking) {}

LoopAnswer LoopWorker::answer(const LoopQuestion& question) {
  LoopAnswer answer;
  if (question.known) {
    closer_ = LoopCloser(config_, tracking_);
    for (const KeyframeView& view : *question.known) closer_.addKeyframe(view);
  }
  if (!question.corrected.empty()) closer_.setPoses(question.corrected);
  if (question.keyframe) {
    if (question.keyframe->id == 0) closer_ = LoopCloser(config_, tracking_);  // a new map
    Stopwatch watch;
    closer_.addKeyframe(*question.keyframe);
    answer.loops = closer_.findLoops();
    answer.verification_ms = watch.lapMs();
  }
  if (question.place) {
    answer.asked_for_place = true;
    answer.place = findPlace(*question.place);
    ++counts_.searched;
    counts_.found += answer.place ? 1 : 0;
  }
  answer.counts = closer_.counts();
  answer.counts.searched = counts_.searched;
  answer.counts.found = counts_.found;
  return answer;
}

std::optional<PlaceVerdict> LoopWorker::findPlace(const PlaceQuestion& question) {
  // Features tell soonest, where they tell; drawing the map finds the rest.
  std::vector<PlaceCandidate> like;
  const Eigen::Isometry3d nowhere = Eigen::Isometry3d::Identity();
  for (const auto& T : closer_.placesLike(keyframeView(question.frame, 0, nowhere, true))) {
    like.emplace_back().T_map_camera = T;
  }
  const PlaceVerdict soon = verifier_.verifyBest(*question.map, question.frame, like, kVerified);
  if (!like.empty() && soon.accepted()) return soon;
  const std::vector<Eigen::Isometry3d> keyframes = closer_.poses();
  if (map_.lock() != question.map) {
    map_ = question.map;
    points_ = thinnedPoints(*question.map);
    const Eigen::Vector3d upright = meanUpright(keyframes, question.T_map_last);
    const auto levels = findLevels(orientedPoints(points_), upright, kUpright_rad);
    up_ = levels ? levels->up : upright;
  }
  if (points_.size() == 0) return std::nullopt;
  const PlaceQuery query = placeQuery(question.frame);
  auto candidates = searchPlaces(points_, query, question.T_map_last, up_, {});
  std::vector<Eigen::Isometry3d> elsewhere = question.elsewhere;
  if (const auto T = standing(keyframes, question.T_map_last, up_)) elsewhere.push_back(*T);
  for (const Eigen::Isometry3d& around : elsewhere) {
    const auto more = searchPlaces(points_, query, around, up_, {});
    candidates.insert(candidates.end(), more.begin(), more.end());
  }
  if (candidates.empty()) return std::nullopt;
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  const std::size_t most = elsewhere.empty() ? kVerified : kVerifiedElsewhere;
  PlaceVerdict verdict = verifier_.verifyBest(*question.map, question.frame, candidates, most);
  if (!verdict.accepted()) return std::nullopt;
  return verdict;
}

}  // namespace pf
