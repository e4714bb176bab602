// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pf {

/// How surfels become a mesh.
struct MeshConfig {
  double cell_m = 0.02;     ///< side of a cell, about that of a triangle
  double bridge_m = 0.035;  ///< the mesh ends so far beyond the last disc: gaps twice as wide close
  int least_surfels = 2;    ///< a corner of the mesh that fewer surfels reach is left out
  double memory_limit_mb = 4096;  ///< that making it may take
};

/// Throws InputError naming the first value that cannot be.
void validate(const MeshConfig& config);

}  // namespace pf
