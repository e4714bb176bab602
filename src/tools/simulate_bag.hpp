// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "simulator/output.hpp"

namespace pf {

/// A ROS bag with the names of openni2_launch: colour, registered depth, camera_info, masks,
/// people, the true pose on tf and as a topic, and what writeSenses() writes. It gets its name when
/// it is whole; an unfinished one is removed. Throws InputError naming the file.
std::unique_ptr<simulator::Output> openBagOutput(const std::string& path);

}  // namespace pf
