// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "command_line.hpp"

namespace pf {

/// posefusion_map view MAP [-o FILE.html]
void addViewCommand(CommandLine& app);

}  // namespace pf
