// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/graph/pose_graph.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "graph_checks.hpp"

namespace pf {
namespace {

Matrix6d withFloor(const Matrix6d& covariance, double sigma_m, double sigma_rad) {
  Matrix6d sum = 0.5 * (covariance + covariance.transpose());
  sum.diagonal().head<3>().array() += sigma_m * sigma_m;
  sum.diagonal().tail<3>().array() += sigma_rad * sigma_rad;
  return sum;
}

}  // namespace

PoseGraph::PoseGraph(const GraphConfig& config, std::vector<Keyframe> keyframes,
                     std::vector<PoseConstraint> constraints, int version)
    : config_(config),
      keyframes_(std::move(keyframes)),
      constraints_(std::move(constraints)),
      version_(version) {
  checkGraph(keyframes_, constraints_, version_);
  const auto first =
      std::stable_partition(constraints_.begin(), constraints_.end(),
                            [](const auto& c) { return c.kind != ConstraintKind::reckoned; });
  reckoned_.assign(first, constraints_.end());
  constraints_.erase(first, constraints_.end());
}

int PoseGraph::addKeyframe(Keyframe keyframe) {
  keyframe.id = static_cast<int>(keyframes_.size());
  throwUnlessUsable(keyframe);
  keyframes_.push_back(keyframe);
  return keyframe.id;
}

int PoseGraph::addKeyframe(Keyframe keyframe, int from, const Matrix6d& covariance) {
  keyframe.id = static_cast<int>(keyframes_.size());
  throwUnlessUsable(keyframe);
  PoseConstraint step;
  step.kind = ConstraintKind::odometry;
  step.from = from;
  step.to = keyframe.id;
  throwUnlessBetween(step, keyframes_.size() + 1);
  step.T_from_to =
      keyframes_[static_cast<std::size_t>(from)].T_map_camera.inverse() * keyframe.T_map_camera;
  step.covariance = withFloor(covariance, config_.odometry_sigma_m, config_.odometry_sigma_rad);
  throwUnlessUsable(step);
  keyframes_.push_back(keyframe);
  constraints_.push_back(step);
  return keyframe.id;
}

int PoseGraph::addFragment(Keyframe first, PoseConstraint reckoned) {
  reckoned.kind = ConstraintKind::reckoned;
  reckoned.to = static_cast<int>(keyframes_.size());
  throwUnlessBetween(reckoned, keyframes_.size() + 1);
  throwUnlessUsable(reckoned);
  const int id = addKeyframe(first);
  reckoned_.push_back(reckoned);
  return id;
}

std::vector<PoseConstraint> PoseGraph::keptConstraints() const {
  std::vector<PoseConstraint> kept = constraints_;
  kept.insert(kept.end(), reckoned_.begin(), reckoned_.end());
  return kept;
}

void PoseGraph::addLoop(const PoseConstraint& loop) {
  const PoseConstraint checked = checkedLoop(loop);
  if (fragmentOf(loop.from) != fragmentOf(loop.to)) {
    throw std::invalid_argument("a loop between two fragments: expected joinFragment()");
  }
  waiting_.push_back(checked);
}

PoseConstraint PoseGraph::checkedLoop(const PoseConstraint& loop) const {
  PoseConstraint checked = loop;
  checked.kind = ConstraintKind::loop;
  throwUnlessBetween(checked, keyframes_.size());
  checked.covariance = withFloor(loop.covariance, config_.loop_sigma_m, config_.loop_sigma_rad);
  throwUnlessUsable(checked);
  return checked;
}

}  // namespace pf
