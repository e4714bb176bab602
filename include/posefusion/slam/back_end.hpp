// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/graph/pose_graph.hpp"
#include "posefusion/loop/closer.hpp"
#include "posefusion/slam/reckoning.hpp"
#include "posefusion/tracking/tracker.hpp"

namespace pf {

/// A frame that was fused, as the graph takes it.
struct FusedFrame {
  std::int64_t stamp_ns = 0;
  std::int32_t map_frame = 0;  ///< SurfelMap::frame() that its surfels have
  MapPose pose;
  Matrix6d covariance = Matrix6d::Zero();  ///< of the twist (m, rad) in the camera frame
  bool is_return = false;  ///< relocalised: tied to the nearest keyframe, not to the last
  /// Of a return, where it is measured: the pose had the camera not been lost but carried on.
  PosePrior carried;
  /// Where the place of its fragment is not known: its pose by dead reckoning, in the first.
  std::optional<ProvisionalPose> reckoned;
};

/// The keyframes, their pose graph, and the poses of all frames. A frame's pose is kept relative to
/// the last keyframe before it, so that a correction moves all. Not thread safe.
class BackEnd {
 public:
  explicit BackEnd(const GraphConfig& config) : graph_(config) {}

  /// Continues a saved graph and trajectory.
  BackEnd(PoseGraph graph, std::vector<FrameRecord> frames)
      : graph_(std::move(graph)),
        frames_(std::move(frames)),
        loaded_frames_(frames_.size()),
        loaded_keyframes_(graph_.keyframes().size()) {}

  /// The keyframe that saw the fragment from about this pose, of those with lower numbers than
  /// `before`; -1: the fragment has none.
  int nearest(const MapPose& pose, int before = std::numeric_limits<int>::max()) const;

  /// Takes in a fused frame. Returns the number of the keyframe that it has become, or -1. The
  /// first one of a fragment is tied to no other; one in another fragment than the last is a
  /// return. A camera may be lost because drift has laid the place where it arrives over another;
  /// having returned there, it closes a loop by the way that it came, which waits for the next
  /// close().
  int add(const FusedFrame& frame);

  /// A pose by dead reckoning, as a constraint from the last keyframe in use of the first fragment.
  /// Nothing where there is none.
  std::optional<PoseConstraint> reckonedFrom(const ProvisionalPose& pose) const;

  /// Keeps the pose of a located frame (fused or not), by the last keyframe of its fragment;
  /// nothing before the first.
  void record(std::int64_t stamp_ns, const MapPose& pose);

  /// The graph, to be corrected in another thread; see PoseGraph::handOver().
  PoseGraph handOver() { return graph_.handOver(); }

  /// Takes the corrected graph up, and counts what became of its loops. Returns what the map is to
  /// follow, in this order.
  std::vector<Deformation> takeUp(PoseGraph&& corrected, const ClosedLoops& closed);

  /// A step of tracking measured anew; see PoseGraph::retrack().
  Deformation retrack(const PoseConstraint& step);

  /// The step by which a keyframe was tracked on from the one before, into what no other keyframe
  /// sees from nearer. Nothing for the first of a piece, and where the camera is back: there the
  /// map that it was tracked against is older than the step, and holds it.
  std::optional<PoseConstraint> stepTo(int keyframe) const;

  /// The poses of the frames recorded here (not of loaded ones) as they are known now, without
  /// those of fragments whose place is not known.
  Trajectory trajectory() const;

  /// All recorded frames, loaded ones first.
  const std::vector<FrameRecord>& frames() const { return frames_; }
  std::size_t loadedFrames() const { return loaded_frames_; }
  std::size_t loadedKeyframes() const { return loaded_keyframes_; }

  const PoseGraph& graph() const { return graph_; }
  /// The poses of the keyframes, in their order.
  std::vector<MapPose> keyframePoses() const;

  struct Counts {
    std::size_t accepted = 0;   ///< corrections of the graph
    std::size_t refused = 0;    ///< loops inconsistent with the others
    std::size_t joined = 0;     ///< fragments whose place was found
    std::size_t withdrawn = 0;  ///< loops accepted earlier, since rejected
  };
  const Counts& counts() const { return counts_; }

 private:
  PoseGraph graph_;
  std::vector<FrameRecord> frames_;
  std::size_t loaded_frames_ = 0, loaded_keyframes_ = 0;
  Counts counts_;
};

}  // namespace pf
