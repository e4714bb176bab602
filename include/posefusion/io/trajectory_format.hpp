// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "posefusion/core/trajectory.hpp"

namespace pf {

/// How other systems and benchmarks write trajectories.
enum class TrajectoryFormat {
  automatic,  ///< recognised by the first line that is no comment
  tum,        ///< stamp (s) tx ty tz qx qy qz qw
  kitti,      ///< the upper three rows of the pose's matrix, row by row; no stamps
  euroc       ///< stamp (ns), tx, ty, tz, qw, qx, qy, qz; further columns are left out
};

/// The words for them: auto, tum, kitti, euroc.
const std::vector<std::string>& trajectoryFormats();

/// By its word. Throws InputError for another one.
TrajectoryFormat trajectoryFormatNamed(const std::string& name);

struct ReadTrajectory {
  Trajectory poses;  ///< in the order of their stamps
  /// Else the stamps are the numbers of the lines, in seconds: what KITTI's poses are matched by.
  bool has_stamps = true;
};

/// Throws InputError naming file, line, and what was expected there.
ReadTrajectory readTrajectory(const std::string& path,
                              TrajectoryFormat format = TrajectoryFormat::automatic);

}  // namespace pf
