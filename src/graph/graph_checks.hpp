// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "posefusion/graph/constraint.hpp"
#include "posefusion/graph/keyframe.hpp"

namespace pf {

/// Throw std::invalid_argument naming what no graph can hold.
void throwUnlessUsable(const Keyframe& keyframe);
void throwUnlessUsable(const PoseConstraint& constraint);
/// Ends at two different ones of so many keyframes.
void throwUnlessBetween(const PoseConstraint& constraint, std::size_t keyframes);

/// Throws InputError naming the first keyframe or constraint of a saved graph that cannot be.
void checkGraph(const std::vector<Keyframe>& keyframes,
                const std::vector<PoseConstraint>& constraints, int version);

}  // namespace pf
