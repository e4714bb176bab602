// SPDX-License-Identifier: BSD-3-Clause
// Keyframes that others represent: a graph grows with the places seen, not with time.
#include <algorithm>

#include "posefusion/core/symmetric.hpp"

#include "posefusion/graph/pose_graph.hpp"

namespace pf {
namespace {

// Keyframes that are still measured, or hold what is being seen.
constexpr int kLatest = 100;

/// A constraint that ends at the keyframe `retired`, between the other end and `carrier`, which
/// stand to each other as they do in the graph. `tie`: covariance of that, twist in the camera of
/// `retired`.
PoseConstraint handedOn(const PoseConstraint& c, const Keyframe& retired, const Keyframe& carrier,
                        const Matrix6d& tie) {
  const Eigen::Isometry3d T_carrier_retired = carrier.T_map_camera.inverse() * retired.T_map_camera;
  PoseConstraint on = c;
  // More than one measurement: no step of tracking any more.
  if (c.kind == ConstraintKind::odometry) on.kind = ConstraintKind::loop;
  if (c.from == retired.id) {
    const Matrix6d A = adjoint(c.T_from_to.inverse());
    on.from = carrier.id;
    on.T_from_to = orthonormalised(T_carrier_retired * c.T_from_to);
    on.covariance = c.covariance + propagated(A, tie);
  } else {
    const Matrix6d A = adjoint(T_carrier_retired);
    on.to = carrier.id;
    on.T_from_to = orthonormalised(c.T_from_to * T_carrier_retired.inverse());
    on.covariance = A * (c.covariance + tie) * A.transpose();
  }
  on.covariance = (0.5 * (on.covariance + on.covariance.transpose())).eval();
  return on;
}

bool isBetween(const PoseConstraint& c, int a, int b) {
  return (c.from == a && c.to == b) || (c.from == b && c.to == a);
}

bool endsAt(const PoseConstraint& c, int keyframe) {
  return c.from == keyframe || c.to == keyframe;
}

/// Of two loops between the same keyframes the more certain one stays.
void addLoopOnce(std::vector<PoseConstraint>& constraints, const PoseConstraint& loop) {
  const auto same = std::find_if(constraints.begin(), constraints.end(), [&](const auto& c) {
    return c.kind == ConstraintKind::loop && isBetween(c, loop.from, loop.to);
  });
  if (same == constraints.end()) {
    constraints.push_back(loop);
  } else if (loop.covariance.trace() < same->covariance.trace()) {
    *same = loop;
  }
}

}  // namespace

std::vector<int> PoseGraph::retire() {
  std::vector<int> retired;
  const int most = config_.keyframes_at_a_place;
  const auto isNear = [&](const Keyframe& a, const Keyframe& b) {
    // Most pairs are far apart, which costs less to see than how they stand to each other.
    const Eigen::Vector3d apart = a.T_map_camera.translation() - b.T_map_camera.translation();
    return apart.norm() <= config_.keyframe_distance_m && a.id != b.id && !a.isRetired() &&
           a.fragment == b.fragment &&
           isWithin(a.T_map_camera.inverse() * b.T_map_camera, config_.keyframe_distance_m,
                    config_.keyframe_angle_rad);
  };
  for (int i = static_cast<int>(keyframes_.size()) - 1 - kLatest; most > 0 && i > 0; --i) {
    const Keyframe& k = keyframes_[static_cast<std::size_t>(i)];
    if (k.isRetired()) continue;
    const auto others = std::count_if(keyframes_.begin(), keyframes_.end(),
                                      [&](const Keyframe& other) { return isNear(other, k); });
    const PoseConstraint* tie = others < most ? nullptr : bestTie(i);
    if (tie == nullptr) continue;
    retire(i, PoseConstraint(*tie));
    retired.push_back(i);
  }
  std::reverse(retired.begin(), retired.end());
  return retired;
}

/// Of the constraints that tie a keyframe to an older one of about the same view.
const PoseConstraint* PoseGraph::bestTie(int keyframe) const {
  const auto pose = [&](int i) { return keyframes_[static_cast<std::size_t>(i)].T_map_camera; };
  const PoseConstraint* best = nullptr;
  for (const PoseConstraint& c : constraints_) {
    if (std::max(c.from, c.to) != keyframe) continue;
    const bool is_near = isWithin(pose(c.from).inverse() * pose(c.to), config_.keyframe_distance_m,
                                  config_.keyframe_angle_rad);
    const bool is_better = best == nullptr || c.covariance.trace() < best->covariance.trace();
    if (is_near && is_better) best = &c;
  }
  return best;
}

void PoseGraph::retire(int keyframe, const PoseConstraint& tie) {
  Keyframe& k = keyframes_[static_cast<std::size_t>(keyframe)];
  k.follows = tie.from == keyframe ? tie.to : tie.from;
  const Keyframe& carrier = keyframes_[static_cast<std::size_t>(k.follows)];
  Matrix6d covariance = tie.covariance;
  if (tie.from == keyframe) {  // it is of the carrier's camera
    const Matrix6d A = adjoint(tie.T_from_to);
    covariance = propagated(A, covariance);
  }
  for (Keyframe& follower : keyframes_) {
    if (follower.follows == keyframe) follower.follows = carrier.id;
  }
  for (PoseConstraint& c : reckoned_) {
    if (c.from == keyframe) c = handedOn(c, k, carrier, covariance);
  }
  for (std::vector<PoseConstraint>* list : {&constraints_, &waiting_, &doubted_}) {
    const auto first = std::stable_partition(list->begin(), list->end(),
                                             [&](const auto& c) { return !endsAt(c, keyframe); });
    const std::vector<PoseConstraint> ended(first, list->end());
    list->erase(first, list->end());
    for (const PoseConstraint& c : ended) {
      if (!endsAt(c, carrier.id)) addLoopOnce(*list, handedOn(c, k, carrier, covariance));
    }
  }
}

std::optional<PoseConstraint> PoseGraph::inUse(PoseConstraint constraint) const {
  const auto at = [&](int i) -> const Keyframe& { return keyframes_[static_cast<std::size_t>(i)]; };
  const Matrix6d tie = independentCovariance(config_.loop_sigma_m, config_.loop_sigma_rad);
  for (const int end : {constraint.from, constraint.to}) {
    const Keyframe& k = at(end);
    if (k.isRetired()) constraint = handedOn(constraint, k, at(k.follows), tie);
  }
  if (constraint.from == constraint.to) return std::nullopt;
  return constraint;
}

void PoseGraph::moveRetired(const std::vector<Keyframe>& before,
                            std::vector<Keyframe>& after) const {
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (!after[i].isRetired()) continue;
    const auto carrier = static_cast<std::size_t>(after[i].follows);
    const Eigen::Isometry3d &T_old = before[carrier].T_map_camera,
                            &T_new = after[carrier].T_map_camera;
    after[i].fragment = after[carrier].fragment;
    after[i].T_map_camera = before[i].T_map_camera;
    if (T_old.matrix() == T_new.matrix()) continue;
    after[i].T_map_camera = orthonormalised(T_new * T_old.inverse() * before[i].T_map_camera);
  }
}

}  // namespace pf
