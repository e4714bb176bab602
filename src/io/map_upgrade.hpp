// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posefusion/graph/constraint.hpp"
#include "posefusion/graph/keyframe.hpp"
#include "posefusion/map/surfels.hpp"
#include "sqlite.hpp"

namespace pf {

/// Map files of version 1 had one map frame for all fragments: fragment k was begun at x = 500 m *
/// k, and a keyframe's number was that of its place, until a loop joined it. These make of what was
/// read of such a file what is in one of version 2.

/// Each keyframe in the coordinates of its own fragment. One that was tracked from an older one is
/// in the fragment of that, wherever it had come to.
void upgradeKeyframes(std::vector<Keyframe>& keyframes,
                      const std::vector<PoseConstraint>& constraints);

/// Surfels of any fragments, by that of the upgraded keyframe in whose time each was made, in their
/// order; consecutive ones of a fragment are one part.
std::vector<FragmentSurfels> upgradeSurfels(const SurfelArrays& surfels,
                                            const std::vector<Keyframe>& keyframes);

/// Makes the tables of an older version those of the present one, without blocks and keyframes: the
/// caller writes all of them in the same transaction.
void upgradeTables(const SqliteDatabase& database);

}  // namespace pf
