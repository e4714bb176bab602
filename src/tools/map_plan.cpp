// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <memory>

#include "map_floor.hpp"
#include "map_plans.hpp"
#include "posefusion/grid/floor_plan.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/mesh/surfel_mesh.hpp"

namespace pf {
namespace {

struct PlanOptions {
  std::string file, output;
  PlanConfig config;
};

void writePlan(const PlanOptions& options) {
  requireEnding(options.output, {".svg"});
  validate(options.config);
  const FloorMap map = readFloorMap(options.file);
  const OccupancyGrid grid = gridOf(map, {});
  PlanConfig config = options.config;
  if (config.title.empty()) {
    char text[120];
    const double cell_m2 = grid.cell_m * grid.cell_m;
    std::snprintf(text, sizeof text, "%.1f m² free, %.1f m² of things; walls cut at %.2f m",
                  cell_m2 * static_cast<double>(grid.count(OccupancyGrid::kFree)),
                  cell_m2 * static_cast<double>(grid.count(OccupancyGrid::kOccupied)),
                  config.cut_m);
    config.title = text;
  }
  AtomicFile file(options.output);
  file.stream() << floorPlan(grid, surfelMesh(map.surfels, {}), config);
  file.commit();
  std::printf("%s: %s\n", options.output.c_str(), config.title.c_str());
}

}  // namespace

void addPlanCommand(CommandLine& app) {
  const auto options = std::make_shared<PlanOptions>();
  CommandLine* const command = app.addCommand("plan", "writes a floor plan that can be printed");
  command->addOption("file", options->file, "map file, *.pfdb")->required();
  command->addOption("-o,--output", options->output, "*.svg")->required();
  command->addOption("--cut", options->config.cut_m, "height of the cut through walls (m)");
  command->addOption("--scale", options->config.scale, "50: two centimetres are a metre");
  command->addOption("--title", options->config.title, "line below the plan");
  command->does([options] { writePlan(*options); });
}

}  // namespace pf
