// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/graph/deformation.hpp"

#include <algorithm>

#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

bool isIdentityMotion(const Eigen::Isometry3d& T) {
  return T.matrix() == Eigen::Isometry3d::Identity().matrix();
}

}  // namespace

Deformation::Deformation(int version, std::vector<Node> nodes)
    : version_(version), nodes_(std::move(nodes)) {
  std::stable_sort(nodes_.begin(), nodes_.end(),
                   [](const Node& a, const Node& b) { return a.map_frame < b.map_frame; });
  identity_ = std::all_of(nodes_.begin(), nodes_.end(),
                          [](const Node& n) { return isIdentityMotion(n.correction); });
}

Eigen::Isometry3d Deformation::at(std::int32_t map_frame) const {
  if (identity_) return Eigen::Isometry3d::Identity();
  const auto after =
      std::upper_bound(nodes_.begin(), nodes_.end(), map_frame,
                       [](std::int32_t frame, const Node& n) { return frame < n.map_frame; });
  if (after == nodes_.begin()) return after->correction;
  const auto before = after - 1;
  const bool same = after == nodes_.end() || !before->leads_on || before->map_frame == map_frame ||
                    before->correction.matrix() == after->correction.matrix();
  if (same) return before->correction;
  const double span = static_cast<double>(after->map_frame) - before->map_frame;
  const double share = (static_cast<double>(map_frame) - before->map_frame) / span;
  const Vector6d step = logSe3(before->correction.inverse() * after->correction);
  return before->correction * expSe3(share * step);
}

}  // namespace pf
