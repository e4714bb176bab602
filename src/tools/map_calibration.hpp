// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/io/map_database.hpp"

namespace pf {

/// Prints what the depth of the map `file` was corrected by. Throws InputError naming it where what
/// it says cannot be.
void printCalibration(const MapContent& content, const std::string& file);

/// Writes what the depth of the map `file` was corrected by into the calibration file `output` and,
/// where `picture` is not empty, as colours into that PNG. Throws InputError where the map has no
/// calibration, or naming what cannot be read or written.
void exportCalibration(const std::string& file, const std::string& output,
                       const std::string& picture);

}  // namespace pf
