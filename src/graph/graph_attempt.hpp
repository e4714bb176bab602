// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "posefusion/graph/pose_graph.hpp"

namespace pf {

constexpr const char* kConfirms = "the new loops only confirm what is there";

/// The graph as it would be.
struct PoseGraph::Attempt {
  std::vector<Keyframe> keyframes;
  std::vector<GraphResult::Error> errors;  ///< of the constraints that hold, then of the new ones
  std::string reason;                      ///< why it cannot be accepted; empty: it can
};

}  // namespace pf
