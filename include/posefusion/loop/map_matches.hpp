// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "posefusion/graph/constraint.hpp"
#include "posefusion/loop/config.hpp"
#include "posefusion/loop/keyframe_pair.hpp"

namespace pf {

/// Of pictures that see where the map shows something, how many see beyond it.
struct LookedThrough {
  std::size_t compared = 0, through = 0;
};

/// `views`: placed in the map.
LookedThrough lookedThrough(const SurfelMap& map, const std::vector<KeyframeView>& views,
                            const DepthSensor& sensor);

/// Finds where pictures of one map were taken in another one. The pose of a view in the other map
/// is a hypothesis, which verified() alone confirms. Results are the same for any number of
/// threads.
class MapMatcher {
 public:
  /// `known`: the views of the other map, placed and by rising number; `sensor` took all pictures.
  MapMatcher(const LoopConfig& config, const TrackingConfig& tracking, const DepthSensor& sensor,
             std::vector<KeyframeView> known);

  /// By features: a view as often as there are places that are like it (LoopCloser::placesLike()).
  std::vector<KeyframeView> placesLike(const std::vector<KeyframeView>& seen) const;

  /// By drawing the other map (LoopWorker), which finds what features do not and takes seconds: at
  /// most one place each for some views, spread over all.
  std::vector<KeyframeView> placesIn(const std::shared_ptr<const SurfelMap>& map,
                                     const std::vector<KeyframeView>& seen) const;

  /// The known views nearest to each of these and it, aligned with each other both ways: loops from
  /// the known one, as far as the pictures agree. The numbers of `guesses` are above those known.
  std::vector<PoseConstraint> verified(const std::vector<KeyframeView>& guesses) const;

 private:
  void addPairs(const KeyframeView& guess, std::vector<PoseConstraint>& pairs) const;

  LoopConfig config_;
  TrackingConfig tracking_;
  DepthSensor sensor_;
  std::vector<KeyframeView> known_;
};

}  // namespace pf
