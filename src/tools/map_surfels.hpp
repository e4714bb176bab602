// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/io/map_database.hpp"

namespace pf {

/// The map of a file, whatever memory it takes.
SurfelMap mapOf(const MapReader& reader, const MapContent& content, const std::string& file);

/// From the map of a file to the frame of results (z up).
Eigen::Isometry3d worldOf(const MapContent& content);

/// The stable surfels of a map file in the frame of results. Throws InputError naming the file.
SurfelArrays readStableSurfels(const std::string& file);

}  // namespace pf
