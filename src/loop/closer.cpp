// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/closer.hpp"

#include <algorithm>
#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

constexpr double kNearTurn_rad = 0.8;
constexpr double kMostUnlike = 0.5;  // dissimilarity of ferns that is looked at
constexpr std::size_t kFernMatches = 2;
constexpr std::size_t kPlacesLike = 12;  // keyframes that a lost camera's picture is matched with
// The two directions of a pair must tell the same.
constexpr double kOneWay_m = 0.03, kOneWay_rad = 0.03;

FernConfig fernConfig(const LoopConfig& config) {
  FernConfig ferns;
  ferns.count = config.ferns;
  ferns.seed = static_cast<std::uint32_t>(config.fern_seed);
  ferns.novelty = config.fern_novelty;
  return ferns;
}

Features featuresOf(const KeyframeView& view) {
  FeatureImage image{view.intensity, cv::Mat(), view.camera};
  view.depth_mm.convertTo(image.depth_m, CV_32F, 1e-3);
  return findFeatures(image);
}

}  // namespace

LoopCloser::LoopCloser(const LoopConfig& config, const TrackingConfig& tracking)
    : config_(config), tracking_(tracking), ferns_(fernConfig(config)) {}

void LoopCloser::addKeyframe(const KeyframeView& view) {
  if (!keyframes_.empty() && view.id <= keyframes_.back().view.id) {
    throw InputError("keyframe " + std::to_string(view.id) + ": expected an id above " +
                     std::to_string(keyframes_.back().view.id));
  }
  keyframes_.push_back({view, featuresOf(view), ferns_.encode(view.thumbnail)});
  ++counts_.keyframes;
  if (config_.static_view_rule && !view.nobody_in_view) {
    ++counts_.not_static;
  } else {
    ferns_.harvest(view.id, keyframes_.back().code);
  }
  counts_.ferns = ferns_.size();
}

void LoopCloser::setPoses(const std::vector<Eigen::Isometry3d>& T_map_camera) {
  const auto last = keyframes_.empty() ? -1 : keyframes_.back().view.id;
  if (static_cast<std::int64_t>(T_map_camera.size()) <= last) {
    throw InputError("loop closer: got " + std::to_string(T_map_camera.size()) +
                     " poses, expected one of keyframe " + std::to_string(last));
  }
  for (Keyframe& keyframe : keyframes_) {
    keyframe.view.T_map_camera = T_map_camera[static_cast<std::size_t>(keyframe.view.id)];
  }
}

std::vector<Eigen::Isometry3d> LoopCloser::poses() const {
  std::vector<Eigen::Isometry3d> poses;
  for (const Keyframe& keyframe : keyframes_) poses.push_back(keyframe.view.T_map_camera);
  return poses;
}

std::vector<LoopCloser::Guess> LoopCloser::guesses() const {
  const auto gap = static_cast<std::size_t>(config_.min_gap_keyframes);
  if (keyframes_.size() <= gap) return {};
  const std::size_t old = keyframes_.size() - gap;
  const Keyframe& last = keyframes_.back();
  std::vector<Guess> found;
  for (const FernMatch& match : ferns_.nearest(last.code, ferns_.size())) {
    if (match.dissimilarity > kMostUnlike || found.size() == kFernMatches) break;
    for (std::size_t i = 0; i < old; ++i) {
      if (keyframes_[i].view.id == match.id) found.push_back({i, Eigen::Isometry3d::Identity()});
    }
  }
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < old; ++i) {
    const Eigen::Isometry3d step =
        keyframes_[i].view.T_map_camera.inverse() * last.view.T_map_camera;
    const double far = step.translation().norm() + angleOf(step);
    if (step.translation().norm() < config_.near_m) near.emplace_back(far, i);
  }
  std::sort(near.begin(), near.end());
  near.resize(std::min(near.size(), static_cast<std::size_t>(config_.feature_pairs)));
  for (const auto& [far, i] : near) {
    const FeatureMatch match = matchFeatures(keyframes_[i].features, last.features);
    if (match.found) found.push_back({i, match.T_first_second});
    const Eigen::Isometry3d step =
        keyframes_[i].view.T_map_camera.inverse() * last.view.T_map_camera;
    if (angleOf(step) < kNearTurn_rad) found.push_back({i, step});
  }
  return found;
}

std::vector<Eigen::Isometry3d> LoopCloser::placesLike(const KeyframeView& view) const {
  std::vector<Eigen::Isometry3d> places;
  if (keyframes_.empty()) return places;
  const FernCode code = ferns_.encode(view.thumbnail);
  std::vector<std::pair<double, std::size_t>> alike;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    alike.emplace_back(FernDatabase::dissimilarity(code, keyframes_[i].code), i);
  }
  std::sort(alike.begin(), alike.end());
  alike.resize(std::min(alike.size(), kPlacesLike));
  const Features features = featuresOf(view);
  for (const auto& [dissimilarity, i] : alike) {
    const FeatureMatch match = matchFeatures(keyframes_[i].features, features);
    if (match.found) places.push_back(keyframes_[i].view.T_map_camera * match.T_first_second);
  }
  return places;
}

bool LoopCloser::verify(const Guess& guess, const WorkingFrame& to, LoopConstraint& constraint) {
  ++counts_.compared;
  const KeyframeView& view = keyframes_[guess.index].view;
  const WorkingFrame from = workingFrameOf(view);
  const VerifyLimits limits;
  const PlaceVerdict forth = alignPair(from, to, guess.T_from_to, tracking_, limits);
  if (!forth.accepted()) {
    ++counts_.refused[static_cast<std::size_t>(forth.doubt)];
    return false;
  }
  const Eigen::Isometry3d T = forth.alignment.T_map_camera;
  const PlaceVerdict back = alignPair(to, from, T.inverse(), tracking_, limits);
  const Eigen::Isometry3d circle = T * back.alignment.T_map_camera;
  if (!back.accepted() || !isWithin(circle, kOneWay_m, kOneWay_rad)) {
    ++counts_.one_way;
    return false;
  }
  ++counts_.accepted;
  constraint = {view.id, keyframes_.back().view.id, T, forth.alignment.covariance};
  return true;
}

std::vector<LoopConstraint> LoopCloser::findLoops() {
  std::vector<LoopConstraint> loops;
  if (!config_.enabled || keyframes_.empty()) return loops;
  const std::vector<Guess> found = guesses();
  if (found.empty()) return loops;
  const WorkingFrame to = workingFrameOf(keyframes_.back().view);
  for (const Guess& guess : found) {
    const std::int64_t id = keyframes_[guess.index].view.id;
    const bool known = std::any_of(loops.begin(), loops.end(),
                                   [&](const LoopConstraint& loop) { return loop.from == id; });
    LoopConstraint constraint;
    if (!known && verify(guess, to, constraint)) loops.push_back(constraint);
  }
  return loops;
}

}  // namespace pf
