// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace pf {

/// One point of a coloured surface: position (m), unit normal, colour R G B.
struct SurfacePoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  Eigen::Matrix<unsigned char, 3, 1> color = Eigen::Matrix<unsigned char, 3, 1>::Zero();
};

/// Reads the vertices of a binary little-endian PLY with x y z nx ny nz (float) and red green blue
/// (uchar), and maybe others that are passed over: map.ply of a run, scene_points.ply of a
/// simulated sequence. Throws InputError naming the file.
std::vector<SurfacePoint> loadPoints(const std::string& path);

}  // namespace pf
