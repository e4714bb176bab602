// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "posefusion/core/se3.hpp"

namespace pf {

/// What became of one frame.
struct StatusRow {
  std::int64_t stamp_ns = 0;
  bool has_pose = false;        ///< the pose is this frame's own, not the last one before it
  bool is_provisional = false;  ///< else, that it is by dead reckoning, with its covariance
  std::string state;            ///< of the tracker after it: tracking, lost, ...
  std::string outcome;          ///< fused, or why not: blurred, few_inliers, ...
  std::string reason;           ///< the same in words; may be empty
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  /// Of the twist (m, rad) in the camera frame, of a fused frame or a provisional pose; 0 of
  /// others.
  Matrix6d covariance = Matrix6d::Zero();
};

/// Writes a table with one row for each frame, comma-separated with a line of names: stamp,
/// has_pose and provisional (0 or 1), state, outcome, reason (in quotes), tx ty tz qx qy qz qw, the
/// six standard deviations s_x s_y s_z (m) s_rx s_ry s_rz (rad) and the 21 entries of the
/// covariance's upper triangle, row by row (c_00 c_01 ... c_55). Throws InputError naming the file.
void saveStatus(const std::string& path, const std::vector<StatusRow>& rows);

/// Reads what saveStatus() writes. Throws InputError naming file and line.
std::vector<StatusRow> loadStatus(const std::string& path);

}  // namespace pf
