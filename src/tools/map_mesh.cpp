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

void addMeshCommand(CLI::App& app) {
  const auto options = std::make_shared<MeshOptions>();
  CLI::App* const command = app.add_subcommand("mesh", "writes its surface as coloured triangles");
  command->add_option("file", options->file, "map file, *.pfdb")->required();
  command->add_option("-o,--output", options->output, "the mesh: *.ply, *.obj or *.glb")
      ->required();
  MeshConfig& config = options->config;
  command->add_option("--cell", config.cell_m, "side of a cell, about that of a triangle (m)")
      ->capture_default_str();
  command
      ->add_option("--bridge", config.bridge_m,
                   "the mesh ends so far beyond the last surfel (m): gaps twice as wide close")
      ->capture_default_str();
  command->add_option("--memory-limit", config.memory_limit_mb, "that making it may take (MB)")
      ->capture_default_str();
  command
      ->add_option("--method", options->method,
                   "nets: signed distance and surface nets; poisson, greedy: those of PCL")
      ->check(CLI::IsMember({"nets", "poisson", "greedy"}))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "0: all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->callback([options] { writeMesh(*options); });
}

}  // namespace pf
