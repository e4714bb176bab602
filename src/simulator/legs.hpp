// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulator/body.hpp"

namespace pf::simulator {

/// What legs and neck say at one moment.
struct LegSample {
  double time_s = 0.0;
  /// The body where the legs believe it to be. `odom` is level, and lies where the body began.
  Eigen::Isometry3d T_odom_base = Eigen::Isometry3d::Identity();
  NeckAngles neck;                                                  ///< as measured by the encoders
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();  ///< by those
  double way_m = 0.0;                                               ///< walked so far
  double turned_rad = 0.0;  ///< turned so far, to either side
};

/// Samples from the beginning of the span to its end. Roll and pitch of the body are true (known
/// from gravity); way and heading drift with what is walked and turned; now and then a foot slips,
/// and a step is counted that was none. From the beginning to the end of a fall the legs report
/// anything: that they thrash about, that they stand, or that the body is suddenly elsewhere.
std::vector<LegSample> senseLegs(const CameraPath& path, const LegsConfig& config,
                                 const TimeSpan& span, std::uint32_t seed);

/// Variances of a sample's place (m^2, each axis) and heading (rad^2) in `odom`, as far as a robot
/// knows its legs: slips and falls are not in them.
struct LegVariance {
  double place_m2 = 0.0;
  double heading_rad2 = 0.0;
};
LegVariance varianceOf(const LegsConfig& config, double way_m, double turned_rad);

}  // namespace pf::simulator
