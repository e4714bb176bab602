// SPDX-License-Identifier: BSD-3-Clause
// Constraints that hold, measured again.
#include <algorithm>

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

}  // namespace pf
