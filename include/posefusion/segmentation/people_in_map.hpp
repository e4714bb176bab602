// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "posefusion/segmentation/grid.hpp"
#include "posefusion/segmentation/moving_object.hpp"
#include "posefusion/segmentation/tracked_people.hpp"

namespace pf {

/// The joints of a person in the frame of the camera: each at the depth of the person's mask beside
/// it (median), so that none lies on what is seen past a thin limb. `cells`: of the mask.
SkeletonPoints liftSkeleton(const Person& person, const std::vector<int>& cells,
                            const SceneGrid& grid);

/// Places people in the map, and follows their velocity. Not thread safe.
class PeopleInMap {
 public:
  /// The visible people (those with cells) in uncorrected coordinates (see ModelView).
  /// `T_uncorrected_camera`: of the frame, as far as known.
  std::vector<MovingObject> place(const std::vector<TrackedPerson>& people, const SceneGrid& grid,
                                  const Eigen::Isometry3d& T_uncorrected_camera,
                                  std::int64_t stamp_ns);

  /// Nothing is known of the camera's place.
  void reset() { last_.clear(); }

 private:
  std::vector<MovingObject> last_;
  std::int64_t last_ns_ = 0;
};

}  // namespace pf
