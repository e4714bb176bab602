// SPDX-License-Identifier: BSD-3-Clause
// Fragments find their place: by a loop, where dead reckoning admits it.
#include <algorithm>
#include <cstdio>
#include <utility>

#include "posefusion/graph/drift.hpp"
#include "posefusion/graph/expected_place.hpp"
#include "posefusion/graph/pose_graph.hpp"

namespace pf {

/// Where dead reckoning puts the first keyframe of a fragment, from a keyframe of another: directly
/// or, where both fragments were reckoned from a third, through that.
std::optional<PoseConstraint> PoseGraph::reckonedTo(int fragment, int in) const {
  const auto to = [this](int which) {
    return std::find_if(reckoned_.begin(), reckoned_.end(),
                        [&](const auto& c) { return fragmentOf(c.to) == which; });
  };
  const auto there = to(fragment), back = to(in);
  if (there == reckoned_.end()) return std::nullopt;
  if (fragmentOf(there->from) == in) return *there;
  if (back == reckoned_.end() || fragmentOf(back->from) != fragmentOf(there->from)) {
    return std::nullopt;
  }
  const auto pose = [&](int i) { return keyframes_[static_cast<std::size_t>(i)].T_map_camera; };
  PoseConstraint both = *there;
  both.from = back->to;
  both.T_from_to = orthonormalised((pose(back->from) * back->T_from_to).inverse() *
                                   pose(there->from) * there->T_from_to);
  const Matrix6d A = adjoint(both.T_from_to.inverse());
  both.covariance += A * back->covariance * A.transpose();
  return both;
}

/// What dead reckoning has against a join by this loop, which leads to these poses; empty: nothing.
std::string PoseGraph::unexpected(const PoseConstraint& loop,
                                  const std::vector<Keyframe>& joined) const {
  const auto [stays, moves] = std::minmax({fragmentOf(loop.from), fragmentOf(loop.to)});
  std::optional<PoseConstraint> reckoned = reckonedTo(moves, stays);
  if (!reckoned) return {};
  const auto pose = [&](int i) { return joined[static_cast<std::size_t>(i)].T_map_camera; };
  const int end = fragmentOf(loop.to) == moves ? loop.to : loop.from;
  const std::vector<int> steps = Ways(keyframes_.size(), constraints_).stepsFrom(reckoned->to);
  reckoned->covariance +=
      driftCovariance(config_, steps[static_cast<std::size_t>(end)],
                      (pose(end).translation() - pose(reckoned->to).translation()).norm());
  const ExpectedPlace expected(*this, *reckoned);
  const MapPose found{stays, pose(reckoned->to)};
  if (expected.admits(found)) return {};
  char text[160];
  std::snprintf(text, sizeof text,
                "the fragment would lie where dead reckoning does not lead: a chi-square of %.1f, "
                "expected %.1f or less",
                expected.chiSquare(found), ExpectedPlace::kMostChiSquare);
  return text;
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
  GraphResult result;
  result.reason = unexpected(checked, start);
  if (!result.reason.empty()) {
    result.refused.push_back({checked, result.reason});
    return result;
  }
  result = prove(start, {checked});
  const auto isKnown = [this](const auto& c) { return fragmentOf(c.from) == fragmentOf(c.to); };
  reckoned_.erase(std::remove_if(reckoned_.begin(), reckoned_.end(), isKnown), reckoned_.end());
  return result;
}

}  // namespace pf
