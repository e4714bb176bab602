// SPDX-License-Identifier: BSD-3-Clause
// Constraints that hold, measured again: by better depth, or by pictures in place of tracking.
#include <algorithm>
#include <utility>

#include "graph_attempt.hpp"

namespace pf {

GraphResult PoseGraph::remeasure(const std::vector<PoseConstraint>& constraints) {
  const std::vector<PoseConstraint> before = constraints_;
  for (const PoseConstraint& fresh : constraints) {
    const auto old = std::find_if(constraints_.begin(), constraints_.end(), [&](const auto& c) {
      return c.from == fresh.from && c.to == fresh.to && c.kind == fresh.kind;
    });
    if (old == constraints_.end()) continue;
    PoseConstraint checked = checkedLoop(fresh);
    checked.kind = fresh.kind;
    *old = checked;
  }
  GraphResult result;
  Attempt tried = attemptAll();
  result.reason = tried.reason;
  if (result.reason.empty() && isWorthMoving(tried.keyframes)) {
    accept(tried, result);
  } else if (!result.reason.empty()) {
    constraints_ = before;
  } else {
    result.reason = kConfirms;
  }
  return result;
}

/// Whether no other constraint joins what was before the step with what came after it.
bool PoseGraph::isOnlyWay(const PoseConstraint& step) const {
  return std::none_of(constraints_.begin(), constraints_.end(), [&](const PoseConstraint& c) {
    const bool is_step = c.from == step.from && c.to == step.to;
    return !is_step && std::min(c.from, c.to) < step.to && std::max(c.from, c.to) >= step.to;
  });
}

GraphResult PoseGraph::retrack(const PoseConstraint& step) {
  GraphResult result;
  const auto old = std::find_if(constraints_.begin(), constraints_.end(), [&](const auto& c) {
    return c.kind == ConstraintKind::odometry && c.from == step.from && c.to == step.to;
  });
  if (old == constraints_.end() || !isOnlyWay(*old)) {
    result.reason = "the step does not stand alone";
    return result;
  }
  const Keyframe from = keyframes_[static_cast<std::size_t>(step.from)];
  const Keyframe to = keyframes_[static_cast<std::size_t>(step.to)];
  const Eigen::Isometry3d T_map_to = from.T_map_camera * step.T_from_to;
  const double contradicts = pf::chiSquare(*old, from.T_map_camera, T_map_to);
  if (!(contradicts <= config_.max_chi_square)) {
    result.reason = "tracking and the pictures contradict each other";
    return result;
  }
  *old = checkedLoop(step);
  old->kind = ConstraintKind::odometry;
  const Eigen::Isometry3d T_new_old = T_map_to * to.T_map_camera.inverse();
  std::vector<Deformation::Node> nodes = {{to.map_frame, T_new_old, false, to.fragment}};
  for (int i = step.to - 1; i >= 0 && nodes.size() < 2; --i) {
    const Keyframe& before = keyframes_[static_cast<std::size_t>(i)];
    if (before.fragment != to.fragment) continue;
    nodes.push_back({before.map_frame, Eigen::Isometry3d::Identity(), i == step.from, to.fragment});
  }
  for (std::size_t i = static_cast<std::size_t>(step.to); i < keyframes_.size(); ++i) {
    Keyframe& k = keyframes_[i];
    if (k.fragment == to.fragment) k.T_map_camera = orthonormalised(T_new_old * k.T_map_camera);
  }
  result.accepted = true;
  result.deformation = Deformation(++version_, std::move(nodes));
  return result;
}

}  // namespace pf
