// SPDX-License-Identifier: BSD-3-Clause
#include "map_merger.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <utility>

#include "posefusion/core/se3.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {
namespace {

// Loops of different places that have to agree, and how many more they have to be than those that
// agree on something else.
constexpr std::size_t kEnough = 3, kTimesMore = 2;
// Motions between the maps that differ by less lead to the same; so many are tried at most.
constexpr double kAlike_m = 0.3, kAlike_rad = 0.1;
constexpr std::size_t kMostTried = 8;

}  // namespace

std::string MapMerger::merge(MergedMap& merged) {
  std::vector<PoseConstraint> loops;
  for (const Search search : {&MapMerger::byFeatures, &MapMerger::byMatches, &MapMerger::byDrawing,
                              &MapMerger::byMatches}) {
    if (loops.empty()) loops = found(merged, search);
  }
  merged.agreeing = loops.size();
  if (loops.empty()) return reason_;
  close(loops);
  // What was too much alike, or too little, to be recognised is known now by where it is.
  close(matcher().verified(views(false)));
  merged.loops = loopsBetween();
  if (merged.loops < kEnough) return "the pose graphs contradict what was recognised";
  return contradiction();
}

/// The views of one of the maps, where they are.
MapMerger::Views MapMerger::views(bool of_first) const {
  Views views;
  for (const KeyframeView& view : mapper_.keyframeViews()) {
    if ((view.id < border_) != of_first) continue;
    const Keyframe& at = keyframe(static_cast<int>(view.id));
    views.push_back(view);
    views.back().pose = {at.fragment, at.T_map_camera};
  }
  return views;
}

MapMatcher MapMerger::matcher() const {
  return {config_.loop, config_.tracking, depthSensorOf(config_), views(true)};
}

MapMerger::Views MapMerger::byFeatures() const { return matcher().placesLike(views(false)); }

MapMerger::Views MapMerger::byDrawing() const {
  const auto map = std::make_shared<const SurfelMap>(mapper_.map());
  return withAllOthers(matcher().placesIn(map, views(false)));
}

MapMerger::Views MapMerger::byMatches() const {
  Views guesses;
  for (const PoseConstraint& match : matches_) {
    const Keyframe& from = keyframe(match.from);
    guesses.emplace_back().id = match.to;
    guesses.back().pose = {from.fragment, from.T_map_camera * match.T_from_to};
  }
  return withAllOthers(guesses);
}

/// Where a view is says where all others of its fragment would be.
MapMerger::Views MapMerger::withAllOthers(const Views& guesses) const {
  Views all;
  std::vector<Eigen::Isometry3d> tried;
  const Views second = views(false);
  for (const KeyframeView& guess : guesses) {
    const Keyframe& of_guess = keyframe(static_cast<int>(guess.id));
    const Eigen::Isometry3d T = guess.pose.T_map_camera * of_guess.T_map_camera.inverse();
    const auto is_like = [&](const auto& other) {
      return isWithin(T.inverse() * other, kAlike_m, kAlike_rad);
    };
    if (tried.size() == kMostTried || std::any_of(tried.begin(), tried.end(), is_like)) continue;
    tried.push_back(T);
    for (KeyframeView view : second) {
      if (view.pose.fragment != of_guess.fragment) continue;
      view.pose = {guess.pose.fragment, T * view.pose.T_map_camera};
      all.push_back(std::move(view));
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.id < b.id; });
  return all;
}

/// Takes in what a search finds. Returns loops that can be believed; none: the reason is known
/// then.
std::vector<PoseConstraint> MapMerger::found(MergedMap& merged, Search search) {
  for (const PoseConstraint& match : matcher().verified((this->*search)())) {
    const auto is_same = [&](const auto& other) {
      return other.from == match.from && other.to == match.to;
    };
    if (std::none_of(matches_.begin(), matches_.end(), is_same)) matches_.push_back(match);
  }
  merged.recognised = matches_.size();
  const PoseGraph& graph = mapper_.backEnd().graph();
  std::map<std::pair<int, int>, std::vector<PoseConstraint>> by_fragments;
  for (const PoseConstraint& match : matches_) {
    by_fragments[{keyframe(match.from).fragment, keyframe(match.to).fragment}].push_back(match);
  }
  std::vector<PoseConstraint> loops;
  reason_ = "nothing of the second was recognised in the first";
  for (const auto& entry : by_fragments) {
    const Consensus consensus =
        consensusOf(config_.graph, graph.keyframes(), graph.constraints(), entry.second);
    if (!isBelieved(consensus)) continue;
    loops.insert(loops.end(), consensus.agreeing.begin(), consensus.agreeing.end());
  }
  return loops;
}

bool MapMerger::isBelieved(const Consensus& consensus) {
  const std::size_t agree = consensus.independent, against = consensus.against;
  if (agree > kTimesMore * against && agree >= kEnough) return true;
  const char* what =
      agree >= kEnough ? "what was recognised is contradictory: %zu places agree on how the maps "
                         "lie, %zu on something else"
                       : "too little was recognised: %zu places agree on how the maps lie, %zu on "
                         "something else, expected 3 or more";
  char text[200];
  std::snprintf(text, sizeof text, what, agree, against);
  reason_ = text;
  return false;
}

/// As any loop that is found while mapping: graph, surfels, layers and poses follow.
void MapMerger::close(const std::vector<PoseConstraint>& loops) {
  LoopAnswer answer;
  for (const PoseConstraint& loop : loops) {
    answer.loops.push_back({loop.from, loop.to, loop.T_from_to, loop.covariance});
  }
  mapper_.take(answer);
  mapper_.settle();
}

/// Places that look alike and are not the same: pictures of one map look through the walls of the
/// other. Empty: they do not.
std::string MapMerger::contradiction() const {
  LookedThrough all;
  for (const bool of_first : {true, false}) {
    SurfelMap other = mapper_.map();
    other.removeIf([&](const SurfelArrays& s, std::size_t i) {
      return (s.created[i] < border_frame_) == of_first;
    });
    const LookedThrough some = lookedThrough(other, views(of_first), depthSensorOf(config_));
    all.compared += some.compared;
    all.through += some.through;
  }
  if (2 * all.through <= all.compared) return {};
  return std::to_string(all.through) + " of " + std::to_string(all.compared) +
         " pictures look through what the other map shows: the places look alike, and are not the "
         "same";
}

std::size_t MapMerger::loopsBetween() const {
  const auto& all = mapper_.backEnd().graph().constraints();
  return static_cast<std::size_t>(std::count_if(
      all.begin(), all.end(), [&](const auto& c) { return c.from < border_ && c.to >= border_; }));
}

}  // namespace pf
