// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "posefusion/calibration/depth_field.hpp"
#include "posefusion/core/camera.hpp"
#include "posefusion/core/depth_sensor.hpp"
#include "posefusion/graph/deformation.hpp"
#include "posefusion/graph/keyframe.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// What is newly known of the depth camera, as it moves what its depth has made. Surfels are means
/// of many frames, near ones above all: each is moved along the rays of the keyframes of its making
/// and of its last support, weighted as fusion weighs them, from where they were to where they are.
struct DepthStep {
  DepthField field;  ///< added to what depth was corrected by (1/m)
  PinholeCamera camera;
  std::vector<Keyframe> keyframes;  ///< where they are by the new depth
  DepthSensor sensor{};
  double left_per_m = 0;  ///< standard deviation of what is still not known (1/m)
  Deformation motion{};   ///< that has taken the keyframes there
};

/// Moves each surfel, position, normal and radius, and lowers its weight to what is then known of
/// it, by two keyframes of its fragment: the last one when it was made (the first, for what is
/// older), and the last one when it was seen. Behind their cameras depth does not move it; without
/// a keyframe it stays. The result does not depend on the number of threads.
void correctDepth(SurfelMap& map, const DepthStep& step);

/// The same of some blocks.
void correctDepth(SurfelMap& map, const DepthStep& step, const std::vector<std::uint32_t>& blocks);

}  // namespace pf
