// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/surfel_map.hpp"

namespace pf {

std::size_t SurfelMap::capacity() const {
  return static_cast<std::size_t>(config_.memory_limit_mb * 1024.0 * 1024.0) /
         SurfelArrays::bytesPerSurfel();
}

std::size_t SurfelMap::stableCount() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < surfels_.size(); ++i) count += isStable(i) ? 1 : 0;
  return count;
}

void SurfelMap::clear() {
  surfels_.forEachArray([](auto& array) { array.clear(); });
  frame_ = -1;
  refused_ = 0;
}

}  // namespace pf
