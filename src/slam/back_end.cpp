// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/back_end.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "posefusion/core/se3.hpp"

namespace pf {

int BackEnd::nearest(const MapPose& pose, int before) const {
  int nearest = -1;
  double least = std::numeric_limits<double>::max();
  for (const Keyframe& keyframe : graph_.keyframes()) {
    if (keyframe.fragment != pose.fragment || keyframe.id >= before || keyframe.isRetired()) {
      continue;
    }
    const Eigen::Isometry3d step = keyframe.T_map_camera.inverse() * pose.T_map_camera;
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
  keyframe.T_map_camera = frame.pose.T_map_camera;
  keyframe.fragment = frame.pose.fragment;
  const int near = nearest(frame.pose);
  if (near < 0) {
    const auto reckoned = frame.reckoned ? reckonedFrom(*frame.reckoned) : std::nullopt;
    return reckoned ? graph_.addFragment(keyframe, *reckoned) : graph_.addKeyframe(keyframe);
  }
  const Keyframe last = graph_.keyframes().back();
  const bool is_same_fragment = last.fragment == keyframe.fragment;
  if (frame.is_return || !is_same_fragment) {
    const int id = graph_.addKeyframe(keyframe, near, frame.covariance);
    if (frame.carried.is_measured && is_same_fragment) {
      graph_.addLoop({last.id, id, last.T_map_camera.inverse() * frame.carried.T_map_camera,
                      frame.carried.covariance, ConstraintKind::loop});
    }
    return id;
  }
  const Eigen::Isometry3d step = last.T_map_camera.inverse() * frame.pose.T_map_camera;
  const GraphConfig& config = graph_.config();
  if (isWithin(step, config.keyframe_distance_m, config.keyframe_angle_rad)) return -1;
  return graph_.addKeyframe(keyframe, last.id, frame.covariance);
}

std::optional<PoseConstraint> BackEnd::reckonedFrom(const ProvisionalPose& pose) const {
  const auto& keyframes = graph_.keyframes();
  const auto last = std::find_if(keyframes.rbegin(), keyframes.rend(), [](const Keyframe& k) {
    return k.fragment == kFirstFragment && !k.isRetired();
  });
  if (last == keyframes.rend()) return std::nullopt;
  PoseConstraint reckoned;
  reckoned.kind = ConstraintKind::reckoned;
  reckoned.from = last->id;
  reckoned.T_from_to = last->T_map_camera.inverse() * pose.T_map_camera;
  reckoned.covariance = pose.covariance;
  return reckoned;
}

void BackEnd::record(std::int64_t stamp_ns, const MapPose& pose) {
  const auto& keyframes = graph_.keyframes();
  const auto last = std::find_if(keyframes.rbegin(), keyframes.rend(),
                                 [&](const Keyframe& k) { return k.fragment == pose.fragment; });
  if (last == keyframes.rend()) return;
  frames_.push_back({stamp_ns, {last->id, last->T_map_camera.inverse() * pose.T_map_camera}});
}

std::vector<Deformation> BackEnd::takeUp(PoseGraph&& corrected, const ClosedLoops& closed) {
  counts_.accepted += closed.accepted;
  counts_.refused += closed.refused;
  counts_.joined += closed.joined;
  counts_.withdrawn += closed.withdrawn;
  return graph_.takeUp(std::move(corrected), closed.deformations);
}

Deformation BackEnd::retrack(const PoseConstraint& step) {
  GraphResult result = graph_.retrack(step);
  return result.accepted ? std::move(result.deformation) : Deformation();
}

std::optional<PoseConstraint> BackEnd::stepTo(int keyframe) const {
  const Keyframe& to = graph_.keyframes().at(static_cast<std::size_t>(keyframe));
  const int from = nearest({to.fragment, to.T_map_camera}, keyframe);
  const auto& all = graph_.constraints();
  const auto found = std::find_if(all.rbegin(), all.rend(), [&](const PoseConstraint& c) {
    return c.kind == ConstraintKind::odometry && c.from == from && c.to == keyframe;
  });
  // A return is tied to the nearest keyframe, but not tracked from it.
  if (found == all.rend() || from + 1 != keyframe) return std::nullopt;
  return *found;
}

Trajectory BackEnd::trajectory() const {
  Trajectory poses;
  poses.reserve(frames_.size() - loaded_frames_);
  for (std::size_t i = loaded_frames_; i < frames_.size(); ++i) {
    const auto keyframe = static_cast<std::size_t>(frames_[i].pose.keyframe);
    if (graph_.keyframes()[keyframe].fragment != kFirstFragment)
      continue;  // its place is not known
    poses.push_back({frames_[i].stamp_ns, graph_.poseOf(frames_[i].pose)});
  }
  return poses;
}

std::vector<MapPose> BackEnd::keyframePoses() const {
  std::vector<MapPose> poses;
  poses.reserve(graph_.keyframes().size());
  for (const Keyframe& k : graph_.keyframes()) poses.push_back({k.fragment, k.T_map_camera});
  return poses;
}

}  // namespace pf
