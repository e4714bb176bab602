// SPDX-License-Identifier: BSD-3-Clause
#include "map_view.hpp"

#include <cstdio>
#include <filesystem>
#include <memory>

#include "map_surfels.hpp"
#include "posefusion/core/stopwatch.hpp"
#include "posefusion/io/map_page.hpp"

namespace pf {
namespace {

struct ViewOptions {
  std::string file, output, title;
  bool surfels = false;
  MapPageConfig config;
};

/// Beside the map, by its name.
std::string outputOf(const ViewOptions& options) {
  if (!options.output.empty()) return options.output;
  return std::filesystem::path(options.file).replace_extension(".html").string();
}

void writeView(const ViewOptions& options) {
  const std::string output = outputOf(options);
  requirePageName(output);
  MapPageConfig config = options.config;
  if (options.surfels) config.kind = PageKind::surfels;
  validate(config);
  const SurfelArrays surfels = readStableSurfels(options.file);
  const std::string title = options.title.empty()
                                ? std::filesystem::path(options.file).filename().string()
                                : options.title;
  Stopwatch watch;
  const PageGeometry shown = saveMapPage(output, surfels, title, config);
  const double made_s = 1e-3 * watch.lapMs();
  std::string what = std::to_string(shown.triangles) + " triangles";
  if (shown.triangles == 0) what = std::to_string(shown.vertices) + " surfels";
  char step[40] = "";
  if (shown.step_m > 0) std::snprintf(step, sizeof step, " in cells of %.3f m", shown.step_m);
  std::printf("%s: %.1f MB, %s%s, of %zu surfels in %.2f s\n", output.c_str(),
              1e-6 * static_cast<double>(std::filesystem::file_size(output)), what.c_str(), step,
              surfels.size(), made_s);
}

}  // namespace

void addViewCommand(CommandLine& app) {
  const auto options = std::make_shared<ViewOptions>();
  CommandLine* const command =
      app.addCommand("view", "writes one HTML page that turns the map in a browser");
  command->addOption("file", options->file, "map file, *.pfdb")->required();
  command->addOption("-o,--output", options->output,
                     "the page: *.html; else beside the map, by its name");
  command->addFlag("--surfels", options->surfels, "surfels as discs in place of the mesh");
  command->addOption("--title", options->title, "else the name of the map file");
  command->addOption(
      "--size-limit", options->config.size_limit_mb,
      "of the page (MB): a large map is shown with larger triangles, or fewer surfels");
  command->addOption("--cell", options->config.mesh.cell_m, "side of a cell of the mesh (m)");
  command->does([options] { writeView(*options); });
}

}  // namespace pf
