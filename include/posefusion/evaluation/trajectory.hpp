// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

namespace posefusion {

struct StampedPose {
  std::int64_t stamp_ns = 0;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
};

/// Poses in the order of their stamps.
using Trajectory = std::vector<StampedPose>;

/// Decimal seconds ("1341845820.819654") to nanoseconds, exactly. Throws InputError.
std::int64_t parseStamp(const std::string& seconds);

/// Nanoseconds as decimal seconds with six decimals, nine where six would lose something.
std::string formatStamp(std::int64_t stamp_ns);

/// Reads the TUM format: `stamp tx ty tz qx qy qz qw` a line, `#` comments. Throws InputError
/// naming file and line.
Trajectory loadTrajectory(const std::string& path);

/// Writes the TUM format to a temporary name and renames it. Throws InputError naming the file.
void saveTrajectory(const std::string& path, const Trajectory& trajectory,
                    const std::string& comment);

}  // namespace posefusion
