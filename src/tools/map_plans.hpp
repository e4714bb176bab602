// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "command_line.hpp"

namespace pf {

/// posefusion_map grid MAP -o FILE.yaml
void addGridCommand(CommandLine& app);

/// posefusion_map plan MAP -o FILE.svg
void addPlanCommand(CommandLine& app);

/// posefusion_map octomap MAP -o FILE.bt
void addOctomapCommand(CommandLine& app);

/// posefusion_map cloud MAP -o FILE.{pcd,ply}
void addCloudCommand(CommandLine& app);

}  // namespace pf
