// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "posefusion/core/map_pose.hpp"
#include "posefusion/graph/pose_graph.hpp"

namespace pf {

/// Where dead reckoning lets a camera be, for places that look like where it is: rooms look alike.
/// The evidence for a place is not judged here, only whether the camera can have come there. Beside
/// the reckoning's own covariance that takes three errors: of the pose that it began at, the last
/// before a loss; of the map, which has drifted between the keyframe of the beginning and the one
/// at the place; and of the place itself. Immutable: for any thread.
class ExpectedPlace {
 public:
  /// `reckoned` leads from a keyframe to the camera, which need not be a keyframe (`to` is not
  /// looked at).
  ExpectedPlace(const PoseGraph& graph, const PoseConstraint& reckoned);

  /// Squared Mahalanobis distance of a found place from the expected one: chi-square with 6 degrees
  /// of freedom where the camera is there. 0 in another fragment than that of the keyframe, where
  /// nothing is known of the way.
  double chiSquare(const MapPose& found) const;

  /// A right place is refused one time in twenty, until dead reckoning has grown less sure; a wrong
  /// one would stay.
  bool admits(const MapPose& found) const { return chiSquare(found) <= kMostChiSquare; }

  /// Whether a pose within `reach_m` of this one, turned as it may be, can be admitted: false only
  /// where none can.
  bool admitsNear(const MapPose& place, double reach_m) const;

  static constexpr double kMostChiSquare = 12.59;  ///< 95 % of 6 degrees of freedom

 private:
  /// A keyframe of the fragment.
  struct Around {
    Eigen::Vector3d position_m;
    int steps = 0;  ///< from the keyframe of the beginning
  };

  /// From the keyframe of the beginning to those that may be the nearest to a position within
  /// reach of this one, the most.
  int mostStepsNear(const Eigen::Vector3d& position_m, double reach_m) const;

  GraphConfig config_;
  std::vector<Around> around_;  ///< those in use
  MapPose expected_;
  Matrix6d covariance_;
};

}  // namespace pf
