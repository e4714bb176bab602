// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/map/surfels.hpp"

namespace pf {

/// Throws InputError naming a file whose name does not end in .pcd or .ply.
void requireCloudName(const std::string& path);

/// Writes surfels as points with normals and colours (metres, their own frame): `.ply` as a run's
/// map.ply; `.pcd`: binary PCD 0.7 of the Point Cloud Library, fields x y z normal_x normal_y
/// normal_z rgb. Under its name when whole. Throws InputError naming the file.
void saveCloud(const std::string& path, const SurfelArrays& surfels);

}  // namespace pf
