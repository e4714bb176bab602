// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "simulated_sequence.hpp"

namespace pf {

/// So many frames of the box are mapped, and so many covered ones lose the camera.
constexpr int kMapped = 60, kCovered = 12;

inline const SimulatedSequence& room() { return exactBox<kMapped>(); }

/// The mapped frame that lies farthest from the last.
inline int farthestFrame() {
  int farthest = 0;
  double most = 0;
  for (int i = 0; i < kMapped; ++i) {
    const double far =
        (room().pose(i).translation() - room().pose(kMapped - 1).translation()).norm();
    if (far > most) farthest = i;
    most = std::max(most, far);
  }
  return farthest;
}

}  // namespace pf
