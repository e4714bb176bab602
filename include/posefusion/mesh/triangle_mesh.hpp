// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace pf {

using MeshColor = Eigen::Matrix<unsigned char, 3, 1>;  ///< R G B

/// A surface as triangles that share their corners.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> positions;               ///< m
  std::vector<Eigen::Vector3f> normals;                 ///< unit, outwards; none, or one each
  std::vector<MeshColor> colors;                        ///< none, or one each
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counterclockwise seen from outside

  std::size_t size() const { return positions.size(); }
};

/// Leaves out the triangles for which keep[triangle] is 0, and the corners that no other needs. The
/// order of what stays is kept.
TriangleMesh onlyKept(const TriangleMesh& mesh, const std::vector<char>& keep);

}  // namespace pf
