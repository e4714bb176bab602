// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "posefusion/io/map_database.hpp"

namespace pf {

/// What a repaired map holds, and what of the damaged one it does not.
struct MapRepair {
  MapCounts kept;
  std::size_t keyframes = 0, frames = 0;  ///< that it holds
  std::vector<std::string> lost;          ///< a sentence each; empty: nothing
};

/// Writes all that can still be read of a map file into a new, whole one; the damaged file and its
/// log stay as they are. A log that is of another map is left out. Where a keyframe is lost, what
/// hangs on it goes with it, and its neighbours are tied by their poses, loosely. Throws InputError
/// naming the file where nothing can be saved (no camera, no keyframe), where `repaired` is there
/// already, or cannot be written.
MapRepair repairMap(const std::string& damaged, const std::string& repaired);

}  // namespace pf
