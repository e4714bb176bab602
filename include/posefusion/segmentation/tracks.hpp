// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posefusion/frame/flow.hpp"
#include "posefusion/pose/skeleton.hpp"
#include "posefusion/segmentation/appearance.hpp"
#include "posefusion/segmentation/grid.hpp"

namespace pf {

/// A person as carried from frame to frame.
struct PersonTrack {
  Person person;       ///< joints in the newest frame
  bool fresh = false;  ///< detected in the newest frame
  double unseen =
      0.0;  ///< frames since the last detection, fewer where the map confirms the person
  bool in_map = false;     ///< the map holds the person by mistake: what it says there is not used
  float depth_m = 0.0F;    ///< median depth in the last frame, 0 = not known yet
  std::vector<int> cells;  ///< the mask, as cells of the grid, moved to the newest frame
  ColourHistogram colour;  ///< of the person; total() is 0 while nothing is known
};

/// Moves people from the last frame into the newest one by the sparse optical flow of their joints
/// and of samples of their masks: a joint follows its own flow where that agrees with the person's
/// median, else the median. `grid`: of the newest frame, of the same size as that of the last one;
/// `flow`: advanced to the newest frame. Where the flow knows no last frame, people stay in place.
void carryTracks(const FlowTracker& flow, const SceneGrid& grid, std::vector<PersonTrack>& tracks);

/// Puts newly detected people in the place of the tracks they continue; the others become new
/// tracks. A person continues the track that holds most of its joints, at least a third. Joints
/// that the detector missed this time are kept from the track.
void mergeDetections(const People& people, const SceneGrid& grid, std::vector<PersonTrack>& tracks);

}  // namespace pf
