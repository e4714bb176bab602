// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "posefusion/slam/saved_map.hpp"

namespace pf {

/// Of what the depth of two maps was corrected by: what comes from more pairs.
std::optional<DepthCalibration> betterKnown(const SavedMap& a, const SavedMap& b);

/// The second map behind the first: its frames, keyframes and fragments have the numbers that come
/// next, so that what moves by the time when it was made still does. Nothing joins the two. The map
/// stands where the first does, and its depth is said to be corrected by betterKnown(). Throws
/// InputError where there are more frames or fragments than numbers.
SavedMap appended(SavedMap first, SavedMap second);

}  // namespace pf
