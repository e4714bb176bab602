// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/back_end.hpp"

#include <limits>
#include <utility>

#include "posefusion/core/se3.hpp"
#include "posefusion/graph/fragments.hpp"

namespace pf {

int BackEnd::nearest(const Eigen::Isometry3d& T_map_camera) const {
  int nearest = 0;
  double least = std::numeric_limits<double>::max();
  for (const Keyframe& keyframe : graph_.keyframes()) {
    const Eigen::Isometry3d step = keyframe.T_map_camera.inverse() * T_map_camera;
    const double far = step.translation().norm() + angleOf(step);
    if (far >= least) continue;
    least = far;
    nearest = keyframe.id;
  }
  return nearest;
}

int BackEnd::add(const FusedFrame& frame) {
  Keyframe keyframe;
  keyframe.stamp_ns = frame.stamp_ns;
  keyframe.map_frame = frame.map_frame;
  keyframe.T_map_camera = frame.T_map_camera;
  keyframe.fragment = fragmentAt(frame.T_map_camera);
  if (graph_.keyframes().empty() || frame.begins_fragment) return graph_.addKeyframe(keyframe);
  const Keyframe last = graph_.keyframes().back();
  if (frame.is_return) {
    const int id = graph_.addKeyframe(keyframe, nearest(frame.T_map_camera), frame.covariance);
    if (frame.carried.is_measured && last.fragment == keyframe.fragment) {
      graph_.addLoop({last.id, id, last.T_map_camera.inverse() * frame.carried.T_map_camera,
                      frame.carried.covariance, ConstraintKind::loop});
    }
    return id;
  }
  const Eigen::Isometry3d step = last.T_map_camera.inverse() * frame.T_map_camera;
  const GraphConfig& config = graph_.config();
  if (isWithin(step, config.keyframe_distance_m, config.keyframe_angle_rad)) return -1;
  return graph_.addKeyframe(keyframe, last.id, frame.covariance);
}

void BackEnd::record(std::int64_t stamp_ns, const Eigen::Isometry3d& T_map_camera) {
  if (graph_.keyframes().empty()) return;
  const Keyframe& last = graph_.keyframes().back();
  frames_.push_back({stamp_ns, {last.id, last.T_map_camera.inverse() * T_map_camera}});
}

std::vector<Deformation> BackEnd::close(const std::vector<LoopConstraint>& loops) {
  std::vector<Deformation> deformations;
  const auto take = [&](GraphResult result) {
    counts_.accepted += result.accepted ? 1 : 0;
    counts_.refused += result.refused.size();
    if (result.accepted) deformations.push_back(std::move(result.deformation));
    return result.accepted;
  };
  const auto fragmentOf = [&](int keyframe) {
    return graph_.keyframes().at(static_cast<std::size_t>(keyframe)).fragment;
  };
  for (const LoopConstraint& loop : loops) {
    const PoseConstraint constraint{static_cast<int>(loop.from), static_cast<int>(loop.to),
                                    loop.T_from_to, loop.covariance, ConstraintKind::loop};
    if (fragmentOf(constraint.from) == fragmentOf(constraint.to)) {
      graph_.addLoop(constraint);
    } else if (take(graph_.joinFragment(constraint))) {
      ++counts_.joined;
    }
  }
  take(graph_.optimise());
  return deformations;
}

Trajectory BackEnd::trajectory() const {
  Trajectory poses;
  poses.reserve(frames_.size() - loaded_frames_);
  for (std::size_t i = loaded_frames_; i < frames_.size(); ++i) {
    const auto keyframe = static_cast<std::size_t>(frames_[i].pose.keyframe);
    if (graph_.keyframes()[keyframe].fragment != 0) continue;  // nobody knows where that is
    poses.push_back({frames_[i].stamp_ns, graph_.poseOf(frames_[i].pose)});
  }
  return poses;
}

std::vector<Eigen::Isometry3d> BackEnd::keyframePoses() const {
  std::vector<Eigen::Isometry3d> poses;
  poses.reserve(graph_.keyframes().size());
  for (const Keyframe& keyframe : graph_.keyframes()) poses.push_back(keyframe.T_map_camera);
  return poses;
}

}  // namespace pf
