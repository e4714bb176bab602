// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/graph/deformation.hpp"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

bool isIdentityMotion(const Eigen::Isometry3d& T) {
  return T.matrix() == Eigen::Isometry3d::Identity().matrix();
}

}  // namespace

Deformation::Deformation(int version, std::vector<Node> nodes, std::optional<Join> join)
    : version_(version), nodes_(std::move(nodes)), join_(join) {
  std::stable_sort(nodes_.begin(), nodes_.end(), [](const Node& a, const Node& b) {
    return std::tie(a.fragment, a.map_frame) < std::tie(b.fragment, b.map_frame);
  });
  identity_ = !join_ && std::all_of(nodes_.begin(), nodes_.end(),
                                    [](const Node& n) { return isIdentityMotion(n.correction); });
}

Eigen::Isometry3d Deformation::at(std::int32_t map_frame, int fragment) const {
  if (identity_) return Eigen::Isometry3d::Identity();
  const auto first = std::partition_point(nodes_.begin(), nodes_.end(),
                                          [&](const Node& n) { return n.fragment < fragment; });
  const auto end = std::partition_point(first, nodes_.end(),
                                        [&](const Node& n) { return n.fragment == fragment; });
  if (first == end) return Eigen::Isometry3d::Identity();
  const auto after = std::upper_bound(
      first, end, map_frame, [](std::int32_t frame, const Node& n) { return frame < n.map_frame; });
  if (after == first) return after->correction;
  const auto before = after - 1;
  const bool same = after == end || !before->leads_on || before->map_frame == map_frame ||
                    before->correction.matrix() == after->correction.matrix();
  if (same) return before->correction;
  const double span = static_cast<double>(after->map_frame) - before->map_frame;
  const double share = (static_cast<double>(map_frame) - before->map_frame) / span;
  const Vector6d step = logSe3(before->correction.inverse() * after->correction);
  return before->correction * expSe3(share * step);
}

Deformation Deformation::with(const std::vector<Node>& more) const {
  std::vector<Node> all = nodes_;
  all.insert(all.end(), more.begin(), more.end());
  return Deformation(version_, std::move(all), join_);
}

std::int32_t Deformation::firstMoved(int fragment) const {
  using Frames = std::numeric_limits<std::int32_t>;
  const Node* before = nullptr;
  for (const Node& node : nodes_) {
    if (node.fragment != fragment) continue;
    if (!isIdentityMotion(node.correction)) {
      if (before == nullptr) return Frames::min();
      return before->leads_on ? before->map_frame + 1 : node.map_frame;
    }
    before = &node;
  }
  return Frames::max();
}

}  // namespace pf
