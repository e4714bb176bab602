// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/map_matches.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "posefusion/core/same_pose.hpp"
#include "posefusion/loop/dense_pairs.hpp"
#include "posefusion/loop/worker.hpp"

namespace pf {
namespace {

// Of a place, with the known views nearest to it: one may be of people, or blurred.
constexpr std::size_t kNearest = 2;
// Views that are looked for by drawing: seconds each, of a large map.
constexpr std::size_t kDrawnFor = 8;
// Views with less of them in the merged map say nothing of it; more than this seen through, and
// things were moved, or the maps lie badly.
constexpr double kLeastOverlap = 0.25, kMostSeenThrough = 0.1;

KeyframeView placed(KeyframeView view, const MapPose& pose) {
  view.pose = pose;
  return view;
}

/// At most so many, spread evenly.
std::vector<KeyframeView> someOf(const std::vector<KeyframeView>& views, std::size_t most) {
  std::vector<KeyframeView> some;
  const std::size_t count = std::min(most, views.size());
  for (std::size_t i = 0; i < count; ++i) some.push_back(views[i * views.size() / count]);
  return some;
}

bool areOfSamePair(const PoseConstraint& a, const PoseConstraint& b) {
  return a.from == b.from && a.to == b.to;
}

/// Guesses so near lead to the same alignment.
bool areAlike(const PoseConstraint& a, const PoseConstraint& b) {
  return areOfSamePair(a, b) && isWithin(a.T_from_to.inverse() * b.T_from_to, kSamePlace);
}

}  // namespace

MapMatcher::MapMatcher(const LoopConfig& config, const TrackingConfig& tracking,
                       const DepthSensor& sensor, std::vector<KeyframeView> known)
    : config_(config), tracking_(tracking), sensor_(sensor), known_(std::move(known)) {}

std::vector<KeyframeView> MapMatcher::placesLike(const std::vector<KeyframeView>& seen) const {
  LoopCloser closer(config_, tracking_, sensor_);
  for (const KeyframeView& view : known_) closer.addKeyframe(view);
  std::vector<KeyframeView> guesses;
  for (const KeyframeView& view : seen) {
    for (const MapPose& pose : closer.placesLike(view)) guesses.push_back(placed(view, pose));
  }
  return guesses;
}

std::vector<KeyframeView> MapMatcher::placesIn(const std::shared_ptr<const SurfelMap>& map,
                                               const std::vector<KeyframeView>& seen) const {
  std::vector<KeyframeView> guesses;
  if (known_.empty()) return guesses;
  LoopWorker worker(config_, tracking_, sensor_, CalibrationConfig{"frozen"});
  LoopQuestion question;
  question.known = known_;
  worker.answer(question);
  question.known.reset();
  std::vector<MapPose> poses;
  for (const KeyframeView& view : known_) poses.push_back(view.pose);
  poses = spreadOut(poses);
  KeyframePicture picture;
  for (const KeyframeView& view : someOf(seen, kDrawnFor)) {
    picture.assign(view, sensor_);
    question.place = std::make_shared<const PlaceQuestion>(
        PlaceQuestion{picture.frame.clone(), map, poses.front(), {poses.begin() + 1, poses.end()}});
    const LoopAnswer answer = worker.answer(question);
    if (answer.place) guesses.push_back(placed(view, answer.place->pose()));
  }
  return guesses;
}

/// Of this view and the known ones nearest to it.
void MapMatcher::addPairs(const KeyframeView& guess, std::vector<PoseConstraint>& pairs) const {
  std::vector<std::pair<double, PoseConstraint>> near;
  for (const KeyframeView& view : known_) {
    if (view.pose.fragment != guess.pose.fragment) continue;
    PoseConstraint pair;
    pair.from = static_cast<int>(view.id);
    pair.to = static_cast<int>(guess.id);
    pair.T_from_to = view.pose.T_map_camera.inverse() * guess.pose.T_map_camera;
    if (!isWithin(pair.T_from_to, config_.near_m, kMostTurn_rad)) continue;
    near.emplace_back(pair.T_from_to.translation().norm() + angleOf(pair.T_from_to), pair);
  }
  std::stable_sort(near.begin(), near.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  near.resize(std::min(near.size(), kNearest));
  for (const auto& entry : near) {
    const PoseConstraint& pair = entry.second;
    const auto is_there = [&](const PoseConstraint& other) { return areAlike(pair, other); };
    if (std::none_of(pairs.begin(), pairs.end(), is_there)) pairs.push_back(pair);
  }
}

std::vector<PoseConstraint> MapMatcher::verified(const std::vector<KeyframeView>& guesses) const {
  std::vector<const KeyframeView*> views;
  for (const KeyframeView& view : known_) views.push_back(&view);
  std::vector<PoseConstraint> pairs;
  for (const KeyframeView& guess : guesses) {
    if (views.empty() || views.back()->id < guess.id) views.push_back(&guess);
    addPairs(guess, pairs);
  }
  std::vector<PoseConstraint> found = measurePairs(views, pairs, tracking_, sensor_);
  const auto is_turned = [](const auto& pair) { return angleOf(pair.T_from_to) > kMostTurn_rad; };
  found.erase(std::remove_if(found.begin(), found.end(), is_turned), found.end());
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::tie(a.to, a.from) < std::tie(b.to, b.from);
  });
  found.erase(std::unique(found.begin(), found.end(), areOfSamePair), found.end());
  return found;
}

LookedThrough lookedThrough(const SurfelMap& map, const std::vector<KeyframeView>& views,
                            const DepthSensor& sensor) {
  LookedThrough result;
  PlaceVerifier verifier({});
  KeyframePicture picture;
  for (const KeyframeView& view : views) {
    picture.assign(view, sensor);
    const ViewAgreement seen = verifier.compare(map, picture.frame, view.pose);
    if (seen.overlap < kLeastOverlap) continue;
    ++result.compared;
    result.through += seen.seen_through > kMostSeenThrough ? 1U : 0U;
  }
  return result;
}

}  // namespace pf
