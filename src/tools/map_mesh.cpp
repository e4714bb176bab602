// SPDX-License-Identifier: BSD-3-Clause
#include "map_mesh.hpp"

#include <tbb/global_control.h>

#include <cstdio>
#include <memory>
#include <optional>

#include "map_mesh_pcl.hpp"
#include "map_surfels.hpp"
#include "posefusion/core/stopwatch.hpp"
#include "posefusion/io/mesh_file.hpp"
#include "posefusion/mesh/surfel_mesh.hpp"

namespace pf {
namespace {

struct MeshOptions {
  std::string file, output;
  MeshConfig config;
  std::string method = "nets";
  int threads = 0;  ///< 0: all
};

TriangleMesh meshBy(const std::string& method, const SurfelArrays& surfels,
                    const MeshConfig& config) {
  if (method == "poisson") return poissonMesh(surfels, config);
  if (method == "greedy") return greedyMesh(surfels, config);
  return surfelMesh(surfels, config);
}

void writeMesh(const MeshOptions& options) {
  requireMeshName(options.output);
  validate(options.config);
  std::optional<tbb::global_control> limit;
  if (options.threads > 0) {
    limit.emplace(tbb::global_control::max_allowed_parallelism, options.threads);
  }
  const SurfelArrays surfels = readStableSurfels(options.file);
  Stopwatch watch;
  const TriangleMesh mesh = meshBy(options.method, surfels, options.config);
  const double made_s = 1e-3 * watch.lapMs();
  saveMesh(options.output, mesh);
  std::printf("%s: %zu triangles, %zu vertices of %zu surfels in %.2f s\n", options.output.c_str(),
              mesh.triangles.size(), mesh.size(), surfels.size(), made_s);
}

}  // namespace

void addMeshCommand(CommandLine& app) {
  const auto options = std::make_shared<MeshOptions>();
  CommandLine* const command = app.addCommand("mesh", "writes its surface as coloured triangles");
  command->addOption("file", options->file, "map file, *.pfdb")->required();
  command->addOption("-o,--output", options->output, "the mesh: *.ply, *.obj or *.glb")->required();
  MeshConfig& config = options->config;
  command->addOption("--cell", config.cell_m, "side of a cell, about that of a triangle (m)");
  command->addOption("--bridge", config.bridge_m,
                     "the mesh ends so far beyond the last surfel (m): gaps twice as wide close");
  command->addOption("--memory-limit", config.memory_limit_mb, "that making it may take (MB)");
  command
      ->addOption("--method", options->method,
                  "nets: signed distance and surface nets; poisson, greedy: those of PCL")
      ->check(oneOf({"nets", "poisson", "greedy"}));
  command->addOption("--threads", options->threads, "0: all cores")->check(range(0, 1024));
  command->does([options] { writeMesh(*options); });
}

}  // namespace pf
