// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "posefusion/calibration/depth_calibration.hpp"
#include "posefusion/core/camera.hpp"
#include "posefusion/graph/constraint.hpp"
#include "posefusion/graph/keyframe.hpp"
#include "posefusion/loop/keyframe_pair.hpp"
#include "posefusion/map/surfels.hpp"
#include "posefusion/tracking/normal_equations.hpp"

namespace pf {

/// What a mapper needs to go on in a map of before.
struct SavedMap {
  PinholeCamera camera;  ///< of the frames, rectified
  Brightness brightness;
  std::vector<FragmentSurfels> surfels;          ///< SurfelMap::parts()
  int frame = -1;                                ///< SurfelMap::frame()
  std::optional<Eigen::Isometry3d> T_world_map;  ///< Mapper::place()
  std::vector<Keyframe> keyframes;
  std::vector<PoseConstraint> constraints;
  int graph_version = 0;
  std::vector<FrameRecord> frames;  ///< trajectory
  /// What keyframes saw, as far as it is known; their poses and cameras need not be set.
  std::vector<KeyframeView> views;
  /// That the depth of keyframes and surfels was corrected by; nothing: it is as measured.
  std::optional<DepthCalibration> calibration{};
};

/// What may become of a loaded map.
enum class MapUse {
  extend,        ///< mapping goes on in it
  localize_only  ///< nothing is fused, nothing changes
};

}  // namespace pf
