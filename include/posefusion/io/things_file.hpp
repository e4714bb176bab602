// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/io/ply.hpp"

namespace pf {

/// A thing left a place and took another one (T_world_thing).
struct ThingMove {
  std::int64_t begin_ns = 0, end_ns = 0;
  Eigen::Isometry3d from = Eigen::Isometry3d::Identity(), to = Eigen::Isometry3d::Identity();
};

/// A thing of a simulated recording that may move.
struct RecordedThing {
  std::string name;
  std::vector<ThingMove> moves;      ///< in the order of time
  Trajectory poses;                  ///< T_world_thing; straight and even between two
  std::vector<SurfacePoint> points;  ///< of its surface, in its own frame
};

/// Reads the things of a simulated sequence: `events.json` and `things/` (docs/simulator.md).
/// Throws InputError naming the file, also where the sequence has no things.
std::vector<RecordedThing> loadThings(const std::string& sequence);

}  // namespace pf
