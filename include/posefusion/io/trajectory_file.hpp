// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/core/trajectory.hpp"

namespace pf {

/// Reads the TUM format: `stamp tx ty tz qx qy qz qw` a line, `#` comments. Throws InputError
/// naming file and line.
Trajectory loadTrajectory(const std::string& path);

/// Writes the TUM format to a temporary name and renames it. Throws InputError naming the file.
void saveTrajectory(const std::string& path, const Trajectory& trajectory,
                    const std::string& comment);

}  // namespace pf
