// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/closer.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/loop/dense_pairs.hpp"

namespace pf {
namespace {

constexpr double kNearTurn_rad = 0.4;  // by poses that may have drifted
constexpr double kMostUnlike = 0.5;    // dissimilarity of ferns that is looked at
constexpr std::size_t kFernMatches = 2;
// Keyframes that a lost camera's picture is matched with, and how many of them at one place: where
// rooms look alike, all of them have to be asked.
constexpr std::size_t kPlacesLike = 12;
constexpr int kAtAPlace = 3;
constexpr double kPlace_m = 1.5;

FernConfig fernConfig(const LoopConfig& config, const DepthSensor& sensor) {
  FernConfig ferns;
  ferns.count = config.ferns;
  ferns.seed = static_cast<std::uint32_t>(config.fern_seed);
  ferns.max_depth_m = sensor.max_depth_m;
  ferns.novelty = config.fern_novelty;
  return ferns;
}

Features featuresIn(const KeyframeView& view) {
  FeatureImage image{view.intensity, cv::Mat(), view.camera};
  view.depth_mm.convertTo(image.depth_m, CV_32F, 1e-3);
  return findFeatures(image);
}

std::ptrdiff_t countNear(const std::vector<MapPose>& poses, const MapPose& pose) {
  return std::count_if(poses.begin(), poses.end(), [&](const MapPose& other) {
    const Eigen::Vector3d way = other.T_map_camera.translation() - pose.T_map_camera.translation();
    return other.fragment == pose.fragment && way.norm() < kPlace_m;
  });
}

}  // namespace

void LoopCounts::addWork(const LoopCounts& before) {
  compared += before.compared;
  accepted += before.accepted;
  local += before.local;
  one_way += before.one_way;
  turned += before.turned;
  searched += before.searched;
  found += before.found;
  for (std::size_t i = 0; i < refused.size(); ++i) refused[i] += before.refused[i];
}

std::size_t LoopCounts::allRefused() const {
  return std::accumulate(refused.begin(), refused.end(), one_way + turned);
}

LoopCloser::LoopCloser(const LoopConfig& config, const TrackingConfig& tracking,
                       const DepthSensor& sensor)
    : config_(config),
      tracking_(tracking),
      sensor_(sensor),
      aligner_(tracking),
      ferns_(fernConfig(config, sensor)) {}

void LoopCloser::addKeyframe(const KeyframeView& view) {
  if (!keyframes_.empty() && view.id <= keyframes_.back().view.id) {
    throw InputError("keyframe " + std::to_string(view.id) + ": expected an id above " +
                     std::to_string(keyframes_.back().view.id));
  }
  keyframes_.push_back({view, ferns_.encode(view.thumbnail), std::nullopt});
  ++counts_.keyframes;
  if (config_.static_view_rule && !view.nobody_in_view) {
    ++counts_.not_static;
  } else {
    ferns_.harvest(view.id, keyframes_.back().code);
  }
  counts_.ferns = ferns_.size();
}

void LoopCloser::forget(const std::vector<int>& ids) {
  if (ids.empty()) return;
  const auto isForgotten = [&](std::int64_t id) {
    return std::binary_search(ids.begin(), ids.end(), static_cast<int>(id));
  };
  keyframes_.erase(std::remove_if(keyframes_.begin(), keyframes_.end(),
                                  [&](const Keyframe& k) { return isForgotten(k.view.id); }),
                   keyframes_.end());
  ferns_.forget(isForgotten);
  counts_.ferns = ferns_.size();
}

void LoopCloser::setPoses(const std::vector<MapPose>& poses) {
  const auto last = keyframes_.empty() ? -1 : keyframes_.back().view.id;
  if (static_cast<std::int64_t>(poses.size()) <= last) {
    throw InputError("loop closer: got " + std::to_string(poses.size()) +
                     " poses, expected one of keyframe " + std::to_string(last));
  }
  for (Keyframe& keyframe : keyframes_) {
    keyframe.view.pose = poses[static_cast<std::size_t>(keyframe.view.id)];
  }
}

std::vector<MapPose> LoopCloser::poses() const {
  std::vector<MapPose> poses;
  for (const Keyframe& keyframe : keyframes_) poses.push_back(keyframe.view.pose);
  return poses;
}

std::vector<LoopCloser::Candidate> LoopCloser::candidates() const {
  const auto gap = static_cast<std::size_t>(config_.min_gap_keyframes);
  if (keyframes_.size() <= gap) return {};
  const std::size_t old = keyframes_.size() - gap;
  const Keyframe& last = keyframes_.back();
  std::vector<Candidate> found;
  for (std::size_t i = 0; i < old; ++i) {
    const MapPose& pose = keyframes_[i].view.pose;
    if (pose.fragment != last.view.pose.fragment) continue;
    const Eigen::Isometry3d step = pose.T_map_camera.inverse() * last.view.pose.T_map_camera;
    const double turn = angleOf(step), shift = step.translation().norm();
    if (shift < config_.near_m && turn < kNearTurn_rad)
      found.push_back({i, shift + turn, step, true});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.far < b.far; });
  found.resize(std::min(found.size(), static_cast<std::size_t>(config_.candidates)));
  std::size_t alike = 0;
  for (const FernMatch& match : ferns_.nearest(last.code, ferns_.size())) {
    if (match.dissimilarity > kMostUnlike || alike == kFernMatches) break;
    for (std::size_t i = 0; i < old; ++i) {
      if (keyframes_[i].view.id != match.id) continue;
      found.push_back({i, 0, Eigen::Isometry3d::Identity()});
      ++alike;
    }
  }
  return found;
}

std::vector<MapPose> LoopCloser::placesLike(const KeyframeView& view) {
  std::vector<MapPose> places;
  if (keyframes_.empty()) return places;
  const FernCode code = ferns_.encode(view.thumbnail);
  std::vector<std::pair<double, std::size_t>> alike;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    alike.emplace_back(FernDatabase::dissimilarity(code, keyframes_[i].code), i);
  }
  std::sort(alike.begin(), alike.end());
  const Features features = featuresIn(view);
  std::vector<MapPose> asked;
  for (const auto& [dissimilarity, i] : alike) {
    if (asked.size() == kPlacesLike) break;
    if (countNear(asked, keyframes_[i].view.pose) == kAtAPlace) continue;
    asked.push_back(keyframes_[i].view.pose);
    const FeatureMatch match = matchFeatures(featuresOf(keyframes_[i]), features, sensor_);
    if (!match.found) continue;
    const MapPose& pose = keyframes_[i].view.pose;
    places.push_back({pose.fragment, pose.T_map_camera * match.T_first_second});
  }
  return places;
}

const Features& LoopCloser::featuresOf(Keyframe& keyframe) {
  if (!keyframe.features) keyframe.features = featuresIn(keyframe.view);
  return *keyframe.features;
}

std::optional<LoopConstraint> LoopCloser::verify(const Candidate& candidate) {
  Keyframe& older = keyframes_[candidate.index];
  from_.assign(older.view, sensor_);
  if (auto loop = verify(older.view.id, candidate.T_from_to)) return loop;
  const FeatureMatch match =
      matchFeatures(featuresOf(older), featuresOf(keyframes_.back()), sensor_);
  if (!match.found) return std::nullopt;
  return verify(older.view.id, match.T_first_second);
}

std::optional<LoopConstraint> LoopCloser::verify(std::int64_t id,
                                                 const Eigen::Isometry3d& T_from_to_guess) {
  if (angleOf(T_from_to_guess) > kNearTurn_rad) return std::nullopt;
  ++counts_.compared;
  const PlaceVerdict forth = aligner_.align(from_, to_, T_from_to_guess);
  if (!forth.accepted()) {
    ++counts_.refused[static_cast<std::size_t>(forth.doubt)];
    return std::nullopt;
  }
  const Eigen::Isometry3d T = forth.alignment.T_map_camera;
  if (angleOf(T) > kMostTurn_rad) {
    ++counts_.turned;
    return std::nullopt;
  }
  if (!aligner_.confirms(from_, to_, T)) {
    ++counts_.one_way;
    return std::nullopt;
  }
  return LoopConstraint{id, keyframes_.back().view.id, T, forth.alignment.covariance};
}

std::vector<PoseConstraint> LoopCloser::remeasure(
    const std::vector<PoseConstraint>& constraints) const {
  std::vector<const KeyframeView*> views;
  for (const Keyframe& keyframe : keyframes_) views.push_back(&keyframe.view);
  return measurePairs(views, constraints, tracking_, sensor_);
}

std::vector<LoopConstraint> LoopCloser::findLoops() {
  std::vector<LoopConstraint> loops;
  if (!config_.enabled || keyframes_.empty()) return loops;
  const std::vector<Candidate> found = candidates();
  if (found.empty()) return loops;
  to_.assign(keyframes_.back().view, sensor_);
  for (const Candidate& candidate : found) {
    if (loops.size() == static_cast<std::size_t>(config_.enough_loops)) break;
    const std::int64_t id = keyframes_[candidate.index].view.id;
    const bool known = std::any_of(loops.begin(), loops.end(),
                                   [&](const LoopConstraint& loop) { return loop.from == id; });
    if (known) continue;
    const auto loop = verify(candidate);
    if (!loop) continue;
    ++counts_.accepted;
    counts_.local += candidate.is_local ? 1 : 0;
    loops.push_back(*loop);
  }
  return loops;
}

}  // namespace pf
