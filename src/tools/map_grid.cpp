// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdio>
#include <memory>

#include "map_floor.hpp"
#include "map_plans.hpp"
#include "posefusion/io/grid_file.hpp"

namespace pf {
namespace {

struct GridOptions {
  std::string file, output;
  GridConfig config;
  bool png = false;
};

void writeGrid(const GridOptions& options) {
  requireGridName(options.output);
  validate(options.config);
  const FloorMap map = readFloorMap(options.file);
  const OccupancyGrid grid = gridOf(map, options.config);
  saveGrid(options.output, grid, options.png);
  const double cell_m2 = grid.cell_m * grid.cell_m;
  const auto area = [&](std::int8_t state) {
    return cell_m2 * static_cast<double>(grid.count(state));
  };
  std::printf(
      "%s: %d x %d cells of %g m: %.1f m2 free, %.1f m2 occupied; the map leans by %.1f "
      "degrees\n",
      options.output.c_str(), grid.cells.cols, grid.cells.rows, grid.cell_m,
      area(OccupancyGrid::kFree), area(OccupancyGrid::kOccupied), map.leaning_rad() * 180 / M_PI);
}

}  // namespace

void addGridCommand(CommandLine& app) {
  const auto options = std::make_shared<GridOptions>();
  CommandLine* const command =
      app.addCommand("grid", "writes what is free and what is occupied, for map_server");
  command->addOption("file", options->file, "map file, *.pfdb")->required();
  command->addOption("-o,--output", options->output, "*.yaml; the image lies beside it")
      ->required();
  GridConfig& config = options->config;
  const auto number = [&](const char* name, double& value, const char* help) {
    command->addOption(name, value, help);
  };
  number("--cell", config.cell_m, "side of a cell (m)");
  number("--lowest", config.lowest_m, "what is lower over the floor is floor (m)");
  number("--highest", config.highest_m, "what is higher over the floor is no obstacle (m)");
  number("--clear", config.clear_m, "free is what rays pass lower than this and higher (m)");
  command->addFlag("--png", options->png, "PNG in place of PGM");
  command->does([options] { writeGrid(*options); });
}

}  // namespace pf
