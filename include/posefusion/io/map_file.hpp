// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// Writes the stable surfels of the first fragment, in the order in which they were made, as binary
/// little-endian PLY: float x y z nx ny nz (metres, moved by `T_file_map`), uchar red green blue,
/// float radius confidence (probability that it stands still). Returns their number. Throws
/// InputError naming the file.
std::size_t saveMap(const std::string& path, const SurfelMap& map,
                    const Eigen::Isometry3d& T_file_map = Eigen::Isometry3d::Identity());

/// Writes these surfels, as they are, into the same kind of file. Throws InputError naming it.
void saveSurfels(const std::string& path, const SurfelArrays& surfels);

/// How many surfels saveMap() would write.
std::size_t savedSurfels(const SurfelMap& map);

/// Reads what saveMap() writes; weights, which it does not have, are 1. Files of
/// version 0.2 and before have frames as confidence, which are read as certain. Throws InputError
/// naming the file.
SurfelArrays loadMap(const std::string& path);

}  // namespace pf
