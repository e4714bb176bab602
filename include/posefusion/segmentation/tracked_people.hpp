// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posefusion/frame/flow.hpp"
#include "posefusion/pose/skeleton.hpp"
#include "posefusion/segmentation/appearance.hpp"
#include "posefusion/segmentation/body.hpp"
#include "posefusion/segmentation/grid.hpp"

namespace pf {

/// A person as carried from frame to frame.
struct TrackedPerson {
  Person person;        ///< joints in the newest frame
  int id = 0;           ///< of the person, from 1 on; 0: not believed yet
  bool fresh = false;   ///< detected in the newest frame
  int detection = -1;   ///< if so: its index there
  double unseen = 0.0;  ///< frames at 30 Hz since the last detection, weighted by what the map says
  bool in_map = false;  ///< the map holds the person by mistake and is not used there
  float depth_m = 0.0F;    ///< median depth in the last frame, 0 = not known yet
  std::vector<int> cells;  ///< the mask, as cells of the grid, moved to the newest frame
  ColorHistogram color;    ///< of the person; total() is 0 while nothing is known
  Body body;               ///< the joints in space, in the newest frame
};

/// Forgets joints farther outside the image than `margin_px`, or nowhere (NaN).
void dropJointsOutside(const SceneGrid& grid, float margin_px, Person& person);

/// Moves people from the last frame into the newest one by the sparse optical flow of their joints
/// and of samples of their masks: a joint follows its own flow where that agrees with the person's
/// median, else the median, and on past the border of the image. `grid`: of the newest frame, of
/// the same size as that of the last one; `flow`: advanced to the newest frame. Where the flow
/// knows no last frame, people stay in place.
void carryPeople(const FlowImages& flow, const SceneGrid& grid, std::vector<TrackedPerson>& people);

/// Replaces carried people by the new detections that continue them; the other detections are added
/// where `may_be_new` (one for each detection) allows it. A detection continues the carried person
/// whose mask holds most of its joints, at least a third. Joints that the detector missed this time
/// are kept from before. `worth`: of the frame, see Pace.
void mergeDetections(const People& detected, const std::vector<bool>& may_be_new,
                     const SceneGrid& grid, float worth, std::vector<TrackedPerson>& people);

}  // namespace pf
