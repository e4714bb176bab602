// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posefusion/graph/config.hpp"
#include "posefusion/graph/constraint.hpp"
#include "posefusion/graph/keyframe.hpp"

namespace pf {

/// Which loops between two pieces of the map agree on the relative pose of the pieces.
struct Consensus {
  /// The largest set of loops that agree with each other; first the one with which most agree.
  std::vector<PoseConstraint> agreeing;
  std::size_t independent = 0;  ///< of them: of other keyframes at other places, in both pieces
  std::size_t against = 0;  ///< the same of the rest, of the most that agree with each other there
};

/// Pairwise consistency (Mangelson et al., "Pairwise consistent measurement set maximization for
/// robust multi-robot map merging", ICRA 2018): two loops and the ways between their ends, one in
/// either piece, are a circle. It has to close within max_chi_square by what both loops may be off
/// by and, for drift, by what as many steps of tracking as the ways have. The largest set is sought
/// greedily. One wrong loop so decides nothing, nor do many of one place that looks like another.
/// `constraints`: hold within the pieces; `loops` all lead between the same two fragments. The same
/// for any number of threads.
Consensus consensusOf(const GraphConfig& config, const std::vector<Keyframe>& keyframes,
                      const std::vector<PoseConstraint>& constraints,
                      const std::vector<PoseConstraint>& loops);

}  // namespace pf
