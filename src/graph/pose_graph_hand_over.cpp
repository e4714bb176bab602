// SPDX-License-Identifier: BSD-3-Clause
// The graph is corrected in another thread while keyframes are added to it.
#include <utility>

#include "posefusion/graph/pose_graph.hpp"

namespace pf {
namespace {

/// For each keyframe from number `known` on the one that it was tracked from; -1: from none.
std::vector<int> parentsOf(std::size_t known, std::size_t keyframes,
                           const std::vector<PoseConstraint>& constraints, std::size_t first) {
  std::vector<int> parents(keyframes - known, -1);
  for (std::size_t i = first; i < constraints.size(); ++i) {
    const PoseConstraint& c = constraints[i];
    const auto to = static_cast<std::size_t>(c.to);
    if (c.kind == ConstraintKind::odometry && to >= known) parents[to - known] = c.from;
  }
  return parents;
}

/// The nodes that keyframes from number `known` on have in a deformation of those before. The last
/// of the nodes before lead on to none: those after them have the same motion, or are returns.
std::vector<Deformation::Node> followers(const std::vector<Keyframe>& keyframes, std::size_t known,
                                         const std::vector<int>& parents,
                                         const Deformation& deformation) {
  std::vector<Deformation::Node> nodes;
  for (std::size_t i = known; i < keyframes.size(); ++i) {
    const Keyframe& k = keyframes[i];
    Deformation::Node node{k.map_frame, Eigen::Isometry3d::Identity(), false, k.fragment};
    if (const int from = parents[i - known]; from >= 0) {
      const auto parent = static_cast<std::size_t>(from);
      const Keyframe& p = keyframes[parent];
      node.correction = parent < known ? deformation.at(p.map_frame, p.fragment)
                                       : nodes[parent - known].correction;
    }
    nodes.push_back(node);
  }
  return nodes;
}

}  // namespace

PoseGraph PoseGraph::handOver() {
  PoseGraph copy = *this;
  copy.handed_over_ = constraints_.size();
  waiting_.clear();
  return copy;
}

std::vector<Deformation> PoseGraph::takeUp(PoseGraph&& corrected,
                                           const std::vector<Deformation>& deformations) {
  const std::size_t known = corrected.keyframes_.size();
  const std::vector<int> parents =
      parentsOf(known, keyframes_.size(), constraints_, corrected.handed_over_);
  std::vector<Deformation> followed;
  for (const Deformation& deformation : deformations) {
    const auto nodes = followers(keyframes_, known, parents, deformation);
    for (std::size_t i = 0; i < keyframes_.size(); ++i) {
      Keyframe& k = keyframes_[i];
      if (i >= known) {
        const Eigen::Isometry3d& T_new_old = nodes[i - known].correction;
        k.T_map_camera = orthonormalised(T_new_old * k.T_map_camera);
      }
      k.fragment = deformation.fragmentAfter(k.fragment);
    }
    followed.push_back(deformation.with(nodes));
  }
  std::move(keyframes_.begin() + static_cast<std::ptrdiff_t>(known), keyframes_.end(),
            std::back_inserter(corrected.keyframes_));
  const auto first_added =
      constraints_.begin() + static_cast<std::ptrdiff_t>(corrected.handed_over_);
  for (auto added = first_added; added != constraints_.end(); ++added) {
    if (const auto c = corrected.inUse(*added)) corrected.constraints_.push_back(*c);
  }
  for (const PoseConstraint& waits : waiting_) {
    if (const auto c = corrected.inUse(waits)) corrected.waiting_.push_back(*c);
  }
  for (const PoseConstraint& added : reckoned_) {
    if (added.to < static_cast<int>(known)) continue;
    if (const auto c = corrected.inUse(added)) corrected.reckoned_.push_back(*c);
  }
  std::swap(*this, corrected);
  return followed;
}

}  // namespace pf
