// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "command_line.hpp"

namespace pf {

/// posefusion_map mesh MAP -o FILE
void addMeshCommand(CommandLine& app);

}  // namespace pf
