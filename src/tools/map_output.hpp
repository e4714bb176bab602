// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/core/camera.hpp"
#include "posefusion/slam/config.hpp"
#include "posefusion/slam/mapper.hpp"

namespace pf {

/// Throws InputError where there is something of that name, or of the one that it has until it is
/// whole: what is made of maps replaces none.
void requireNew(const std::string& output);

/// Writes what a mapper has into the new map file `output`, which is there when it is whole.
/// `settings`: saved in the file. Throws InputError naming what cannot be written.
void writeMap(const Mapper& mapper, const PinholeCamera& camera, const Config& settings,
              const std::string& output);

}  // namespace pf
