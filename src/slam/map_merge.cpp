// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/map_merge.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/graph/consensus.hpp"
#include "posefusion/loop/map_matches.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "posefusion/slam/map_append.hpp"
#include "posefusion/slam/mapper.hpp"

namespace pf {
namespace {

// Loops of different places and moments that have to agree, and how many more they have to be than
// those that agree on something else.
constexpr std::size_t kEnough = 3, kTimesMore = 2;
// Motions between the maps that differ by less lead to the same; so many are tried at most.
constexpr double kAlike_m = 0.3, kAlike_rad = 0.1;
constexpr std::size_t kMostTried = 8;
constexpr double kAnyMemory_mb = 1e6;  // the limit is for mapping: here it would drop surfels

/// The map as a mapper with these settings has it, with its depth corrected.
SavedMap loaded(NamedMap named, const std::optional<DepthCalibration>& calibration,
                const Config& config) {
  try {
    const PinholeCamera camera = named.map.camera;
    Mapper mapper(config);
    if (calibration) mapper.calibrate(*calibration);
    mapper.load(std::move(named.map), MapUse::extend);
    return mapper.saved(camera);
  } catch (const InputError& error) {
    throw InputError(named.name + ": " + error.what());
  }
}

/// Makes the two maps that a mapper has, one appended to the other, one.
class Merger {
 public:
  /// `border`: the number of the second's first keyframe.
  Merger(Mapper& mapper, const Config& config, int border)
      : mapper_(mapper), config_(config), border_(border) {}

  /// Why not; empty: they are one.
  std::string merge(MergedMap& merged) {
    std::vector<PoseConstraint> loops;
    for (const Search search :
         {&Merger::byFeatures, &Merger::byMatches, &Merger::byDrawing, &Merger::byMatches}) {
      if (loops.empty()) loops = found(merged, search);
    }
    merged.agreeing = loops.size();
    if (loops.empty()) return reason_;
    close(loops);
    // What was too much alike, or too little, to be recognised is known now by where it is.
    close(matcher().verified(views(false)));
    merged.loops = loopsBetween();
    return merged.loops >= kEnough ? "" : "the pose graphs contradict what was recognised";
  }

 private:
  using Search = std::vector<KeyframeView> (Merger::*)() const;

  /// The views of one of the maps, where they are.
  std::vector<KeyframeView> views(bool of_first) const {
    std::vector<KeyframeView> views;
    const std::vector<MapPose> poses = mapper_.backEnd().keyframePoses();
    for (const KeyframeView& view : mapper_.keyframeViews()) {
      if ((view.id < border_) != of_first) continue;
      views.push_back(view);
      views.back().pose = poses[static_cast<std::size_t>(view.id)];
    }
    return views;
  }

  MapMatcher matcher() const {
    return {config_.loop, config_.tracking, depthSensorOf(config_), views(true)};
  }

  std::vector<KeyframeView> byFeatures() const { return matcher().placesLike(views(false)); }

  std::vector<KeyframeView> byDrawing() const {
    return matcher().placesIn(std::make_shared<const SurfelMap>(mapper_.map()), views(false));
  }

  /// What each match says of all other views: there they are looked for too.
  std::vector<KeyframeView> byMatches() const {
    std::vector<KeyframeView> guesses;
    std::vector<Eigen::Isometry3d> tried;
    const std::vector<KeyframeView> second = views(false);
    for (const PoseConstraint& match : matches_) {
      const Keyframe &from = keyframe(match.from), &to = keyframe(match.to);
      const Eigen::Isometry3d T = from.T_map_camera * match.T_from_to * to.T_map_camera.inverse();
      const auto is_like = [&](const auto& other) {
        return isWithin(T.inverse() * other, kAlike_m, kAlike_rad);
      };
      if (tried.size() == kMostTried || std::any_of(tried.begin(), tried.end(), is_like)) continue;
      tried.push_back(T);
      for (KeyframeView view : second) {
        if (view.pose.fragment != to.fragment) continue;
        view.pose = {from.fragment, T * view.pose.T_map_camera};
        guesses.push_back(std::move(view));
      }
    }
    std::stable_sort(guesses.begin(), guesses.end(),
                     [](const auto& a, const auto& b) { return a.id < b.id; });
    return guesses;
  }

  /// Takes in what a search finds. Returns loops that can be believed; none: the reason is known
  /// then.
  std::vector<PoseConstraint> found(MergedMap& merged, Search search) {
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

  bool isBelieved(const Consensus& consensus) {
    const std::size_t agree = consensus.independent, against = consensus.against;
    if (agree > kTimesMore * against && agree >= kEnough) return true;
    char text[200];
    std::snprintf(text, sizeof text,
                  agree >= kEnough
                      ? "what was recognised is contradictory: %zu places agree on how "
                        "the maps lie, %zu on something else"
                      : "too little was recognised: %zu places agree on how the maps "
                        "lie, %zu on something else, expected 3 or more",
                  agree, against);
    reason_ = text;
    return false;
  }

  const Keyframe& keyframe(int number) const {
    return mapper_.backEnd().graph().keyframes()[static_cast<std::size_t>(number)];
  }

  /// As any loop that is found while mapping: graph, surfels, layers and poses follow.
  void close(const std::vector<PoseConstraint>& loops) {
    LoopAnswer answer;
    for (const PoseConstraint& loop : loops) {
      answer.loops.push_back({loop.from, loop.to, loop.T_from_to, loop.covariance});
    }
    mapper_.take(answer);
    mapper_.settle();
  }

  std::size_t loopsBetween() const {
    const auto& all = mapper_.backEnd().graph().constraints();
    return static_cast<std::size_t>(std::count_if(all.begin(), all.end(), [&](const auto& c) {
      return c.from < border_ && c.to >= border_;
    }));
  }

  Mapper& mapper_;
  const Config& config_;
  int border_;
  std::vector<PoseConstraint> matches_;
  std::string reason_;
};

/// Fragments that only keyframes from `border` on are in.
std::size_t fragmentsApart(const std::vector<Keyframe>& keyframes, std::size_t border) {
  std::set<int> first, second;
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    (i < border ? first : second).insert(keyframes[i].fragment);
  }
  return static_cast<std::size_t>(std::count_if(
      second.begin(), second.end(), [&](int fragment) { return first.count(fragment) == 0; }));
}

}  // namespace

MergedMap merge(NamedMap first, NamedMap second, const Config& settings) {
  const std::string names = second.name + " does not become one with " + first.name + ": ";
  const PinholeCamera camera = first.map.camera;
  if (!isSameCamera(camera, second.map.camera)) {
    throw InputError(names + "they are of different cameras (" + describe(second.map.camera) +
                     "; " + describe(camera) + ")");
  }
  Config config = settings;
  config.map.memory_limit_mb = kAnyMemory_mb;
  config.graph.keyframes_at_a_place = 0;  // pictures of both are wanted until they are one
  const auto calibration = betterKnown(first.map, second.map);
  SavedMap a = loaded(std::move(first), calibration, config);
  SavedMap b = loaded(std::move(second), calibration, config);
  const std::size_t border = a.keyframes.size(),
                    surfels = surfelsIn(a.surfels) + surfelsIn(b.surfels);
  Mapper mapper(config);
  mapper.load(appended(std::move(a), std::move(b)), MapUse::extend);
  MergedMap merged;
  const std::string reason = Merger(mapper, config, static_cast<int>(border)).merge(merged);
  if (!reason.empty()) throw InputError(names + reason);
  merged.map = mapper.saved(camera);
  merged.apart = fragmentsApart(merged.map.keyframes, border);
  merged.layers = surfels - surfelsIn(merged.map.surfels);
  return merged;
}

std::string MergedMap::text() const {
  char line[240];
  std::snprintf(line, sizeof line,
                "merged: %zu pairs of keyframes recognised, %zu agree; %zu loops between the maps, "
                "%zu double surfels removed, %zu fragments of the second still apart",
                recognised, agreeing, loops, layers, apart);
  return line;
}

}  // namespace pf
