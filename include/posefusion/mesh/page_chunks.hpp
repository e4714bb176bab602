// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "posefusion/map/surfels.hpp"
#include "posefusion/mesh/triangle_mesh.hpp"

namespace pf {

/// A corner of a triangle, or a surfel, as a page has it: 12 bytes, which a graphics card takes as
/// they are.
struct PageVertex {
  std::array<std::uint16_t, 3> place{};  ///< 0 .. 65535 along each side of the chunk's box
  std::array<std::int8_t, 2> normal{};   ///< octahedral, -127 .. 127
  std::array<std::uint8_t, 3> color{};   ///< R G B
  std::uint8_t radius = 0;               ///< 0 .. 255 of the chunk's largest; 0 for a mesh
};
static_assert(sizeof(PageVertex) == 12, "written as it lies");

/// A piece of a map, as large as indices of 16 bits allow.
struct PageChunk {
  /// The largest number is kept for the restart of strips.
  static constexpr std::size_t kMostVertices = 65535;

  Eigen::Vector3f low = Eigen::Vector3f::Zero();   ///< corner of its box, m
  Eigen::Vector3f side = Eigen::Vector3f::Zero();  ///< of the box, m
  float largest_radius_m = 0;
  std::vector<PageVertex> vertices;
  std::vector<std::uint16_t> indices;  ///< three for each triangle; none: surfels

  std::size_t bytes() const {
    return vertices.size() * sizeof(PageVertex) + indices.size() * sizeof(std::uint16_t);
  }
};

/// A mesh with normals and colours in pieces, cut at the middle of the longer side until each is
/// small enough. Places are off by half a 65535th of the piece's side at most (0.1 mm of 10 m),
/// normals by about a degree. The order depends on the mesh alone.
std::vector<PageChunk> pageChunks(const TriangleMesh& mesh);

/// The same of surfels. Those without a finite position, normal or radius are left out; one
/// without a colour is grey.
std::vector<PageChunk> pageChunks(const SurfelArrays& surfels);

/// What a page shows of a vertex. @{
Eigen::Vector3f positionOf(const PageChunk& chunk, const PageVertex& vertex);
Eigen::Vector3f normalOf(const PageVertex& vertex);
/// @}

}  // namespace pf
