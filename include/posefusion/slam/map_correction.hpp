// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "posefusion/calibration/depth_calibration.hpp"
#include "posefusion/calibration/depth_correction.hpp"
#include "posefusion/graph/pose_graph.hpp"
#include "posefusion/loop/keyframe_pair.hpp"
#include "posefusion/map/depth_step.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "posefusion/tracking/config.hpp"

namespace pf {

/// What is newly learned of the depth camera, as all that its depth has made follows.
struct DepthImprovement {
  DepthCalibration learned;  ///< added to what depth was corrected by
  DepthCalibration known;    ///< both together
  DepthStep step;            ///< for surfels; its keyframes are those of the corrected graph
  TrackingConfig tracking;   ///< by which the constraints are measured anew
  cv::Size frame_size;
  std::vector<KeyframeView> views;  ///< of the keyframes
  /// The graph has followed: the last of the deformations is that of the new depth, which surfels
  /// follow by the step.
  bool moves_keyframes = false;

  /// By both together, there and back; by what is new, of frames and of views. Their tables are
  /// made when the correction is prepared. @{
  DepthCorrector corrector{DepthField()}, distorter{DepthField()};
  DepthCorrector of_frames{DepthField()}, of_views{DepthField()};
  /// @}
};

/// A correction of the graph and the map, with the copies that it is made on: any thread may do it
/// while mapping goes on. In this order: loops, constraints measured anew, depth.
struct MapCorrection {
  std::uint64_t number = 0;
  PoseGraph graph;                         ///< PoseGraph::handOver()
  SurfelMap map;                           ///< SurfelMap::resting()
  std::vector<PoseConstraint> loops;       ///< to be closed
  std::vector<PoseConstraint> remeasured;  ///< constraints that hold, measured anew
  std::optional<DepthImprovement> depth;
  std::vector<std::uint32_t> unswept;  ///< blocks in which layers may be left
};

/// The result of a correction.
struct CorrectedMap {
  std::uint64_t number = 0;
  PoseGraph graph;
  ClosedLoops closed;
  SurfelMap before, map;                  ///< see SurfelMap::takeUp()
  std::optional<DepthImprovement> depth;  ///< its views have been corrected
  std::vector<std::uint32_t> swept;       ///< blocks in which no layers are left
  std::vector<int> retired;               ///< keyframes, see PoseGraph::retire()
  bool lays_layers = false;  ///< what was moved may lie double now; where it rested it does not
};

CorrectedMap prepare(MapCorrection correction);

/// How far a keyframe has moved most (m).
double largestShiftM(const std::vector<Keyframe>& before, const std::vector<Keyframe>& after);

/// Corrects the depth of what a keyframe saw.
void correctDepth(DepthCorrector& corrector, KeyframeView& view);

}  // namespace pf
