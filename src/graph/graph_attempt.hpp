// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "posefusion/graph/pose_graph.hpp"

namespace pf {

constexpr const char* kConfirms = "the new loops only confirm what is there";

/// A loop, or a return into a part of the map that the camera was not tracked from: what may be
/// wrong altogether.
bool isSwitchable(const PoseConstraint& constraint);

/// For each keyframe the first keyframe of its connected part.
std::vector<std::size_t> firstOfParts(std::size_t keyframes,
                                      const std::vector<PoseConstraint>& constraints);

/// The graph as it would be.
struct PoseGraph::Attempt {
  std::vector<Keyframe> keyframes;
  std::vector<GraphResult::Error> errors;  ///< of the constraints that hold, then of the new ones
  std::string reason;                      ///< why it cannot be accepted; empty: it can
};

}  // namespace pf
