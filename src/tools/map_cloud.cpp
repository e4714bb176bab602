// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <memory>

#include "map_plans.hpp"
#include "map_surfels.hpp"
#include "posefusion/io/cloud_file.hpp"
#include "posefusion/map/thinned.hpp"

namespace pf {
namespace {

struct CloudOptions {
  std::string file, output;
  double voxel_m = 0;
};

void writeCloud(const CloudOptions& options) {
  requireCloudName(options.output);
  SurfelArrays surfels = readStableSurfels(options.file);
  if (options.voxel_m > 0) surfels = thinned(surfels, static_cast<float>(options.voxel_m));
  saveCloud(options.output, surfels);
  std::printf("%s: %zu points\n", options.output.c_str(), surfels.size());
}

}  // namespace

void addCloudCommand(CommandLine& app) {
  const auto options = std::make_shared<CloudOptions>();
  CommandLine* const command = app.addCommand("cloud", "writes its surfels as a point cloud");
  command->addOption("file", options->file, "map file, *.pfdb")->required();
  command->addOption("-o,--output", options->output, "*.pcd or *.ply")->required();
  command->addOption("--voxel", options->voxel_m, "one point in each cube of this side (m); 0: all")
      ->check(range(0.0, 10.0));
  command->does([options] { writeCloud(*options); });
}

}  // namespace pf
