// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "discs.hpp"
#include "posefusion/mesh/surface_nets.hpp"

namespace pf {

/// What the surfels around say of the vertices of a net.
struct PaintedVertices {
  std::vector<Eigen::Vector3f> normals;
  std::vector<MeshColor> colors;
  std::vector<char> seen;  ///< 1: enough surfels reach it, the nearest within the bridge
};

/// Only surfels of the side that the net faces count. Moves the vertices onto the mean plane of
/// those, by half a cell at most: the mean of a cell's crossings lies inside of corners.
PaintedVertices paint(const SurfelArrays& surfels, const DiscBlocks& blocks,
                      const MeshConfig& config, SurfaceNet& net);

}  // namespace pf
