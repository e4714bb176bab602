// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "posefusion/slam/config.hpp"
#include "posefusion/slam/saved_map.hpp"

namespace pf {

/// A map, and its name in messages.
struct NamedMap {
  std::string name;
  SavedMap map;
};

/// Two maps that have become one.
struct MergedMap {
  SavedMap map;                ///< for Mapper::load()
  std::size_t recognised = 0;  ///< pairs of keyframes, one of each map, whose pictures agree
  std::size_t agreeing = 0;    ///< of them: that agree on how the maps lie to each other
  std::size_t loops = 0;       ///< between the maps, accepted in the end
  std::size_t apart = 0;       ///< fragments of the second map whose place is not known
  std::size_t layers = 0;      ///< surfels mapped a second time, and removed

  std::string text() const;  ///< all of it in one line
};

/// Makes one map of two that one camera, or two that are alike, made of places that they have in
/// common: the second comes into the coordinates of the first. `settings`: of the first. A map
/// without a calibration is corrected by the other's, as Mapper::load() does. Throws InputError
/// naming both where they do not become one, and why: other cameras; nothing of the second is
/// recognised in the first; what is recognised contradicts itself, or is too little to be sure. The
/// same bytes for any number of threads.
MergedMap merge(NamedMap first, NamedMap second, const Config& settings);

}  // namespace pf
