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

GraphResult PoseGraph::joinFragment(const PoseConstraint& loop) {
  const PoseConstraint checked = checkedLoop(loop);
  const int from = fragmentOf(loop.from), to = fragmentOf(loop.to);
  if (from == to) throw std::invalid_argument("both keyframes are of one fragment");
  const auto pose = [&](int i) { return keyframes_[static_cast<std::size_t>(i)].T_map_camera; };
  const Eigen::Isometry3d wanted_to = pose(loop.from) * loop.T_from_to;
  const Eigen::Isometry3d wanted_from = pose(loop.to) * loop.T_from_to.inverse();
  const int stays = std::min(from, to), moves = std::max(from, to);
  const Eigen::Isometry3d step =
      moves == to ? wanted_to * pose(loop.to).inverse() : wanted_from * pose(loop.from).inverse();
  std::vector<Keyframe> start = keyframes_;
  for (Keyframe& k : start) {
    if (k.fragment != moves) continue;
    k.fragment = stays;
    k.T_map_camera = orthonormalised(step * k.T_map_camera);
  }
  return prove(start, {checked});
}

}  // namespace pf
