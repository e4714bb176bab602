// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

namespace pf {

/// posefusion_map grid MAP -o FILE.yaml
void addGridCommand(CLI::App& app);

/// posefusion_map plan MAP -o FILE.svg
void addPlanCommand(CLI::App& app);

/// posefusion_map octomap MAP -o FILE.bt
void addOctomapCommand(CLI::App& app);

/// posefusion_map cloud MAP -o FILE.{pcd,ply}
void addCloudCommand(CLI::App& app);

}  // namespace pf
