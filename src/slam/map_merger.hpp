// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "posefusion/graph/consensus.hpp"
#include "posefusion/loop/map_matches.hpp"
#include "posefusion/slam/map_merge.hpp"
#include "posefusion/slam/mapper.hpp"

namespace pf {

/// Of a mapper that has one map appended to another it makes one that has one map.
class MapMerger {
 public:
  /// `border`: the second's first keyframe, as it is numbered now.
  MapMerger(Mapper& mapper, const Config& config, int border)
      : mapper_(mapper),
        config_(config),
        border_(border),
        border_frame_(keyframe(border).map_frame) {}

  /// Merges the two and fills in `merged`. Returns why they cannot be merged; empty: they are.
  std::string merge(MergedMap& merged);

 private:
  using Views = std::vector<KeyframeView>;
  using Search = Views (MapMerger::*)() const;

  Views views(bool of_first) const;
  MapMatcher matcher() const;
  Views byFeatures() const;
  Views byDrawing() const;
  Views byMatches() const;
  Views withAllOthers(const Views& guesses) const;
  std::vector<PoseConstraint> found(MergedMap& merged, Search search);
  bool isBelieved(const Consensus& consensus);
  void close(const std::vector<PoseConstraint>& loops);
  std::string contradiction() const;
  std::size_t loopsBetween() const;
  const Keyframe& keyframe(int number) const {
    return mapper_.backEnd().graph().keyframes()[static_cast<std::size_t>(number)];
  }

  Mapper& mapper_;
  const Config& config_;
  int border_, border_frame_;
  std::vector<PoseConstraint> matches_;
  std::string reason_;  ///< why nothing is believed yet
};

}  // namespace pf
