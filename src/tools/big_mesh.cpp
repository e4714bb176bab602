// SPDX-License-Identifier: BSD-3-Clause
// For the bench: what a mesh of a big map costs. Copies of a room beside each other are meshed by
// all threads and by one.
#include <tbb/global_control.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "posefusion/core/error.hpp"
#include "posefusion/core/stopwatch.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/mesh/surfel_mesh.hpp"
#include "posefusion/run/run_statistics.hpp"
#include "tool.hpp"

namespace pf {
namespace {

constexpr int kRooms = 4;  // copies in a row
constexpr float kBetweenRooms_m = 0.5F;

struct Options {
  std::string map;
  std::size_t surfels = 4'000'000;
};

float extent(const std::vector<float>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low + kBetweenRooms_m;
}

/// So many surfels: rooms in rows.
SurfelArrays copiesOf(const SurfelArrays& room, std::size_t count) {
  if (room.size() == 0) throw InputError("the map has no surfels");
  const float width = extent(room.x), depth = extent(room.y);
  SurfelArrays all;
  all.forEachArray([&](auto& array) { array.reserve(count); });
  for (int n = 0; all.size() < count; ++n) {
    const std::size_t begin = all.size();
    all.append(room);
    for (std::size_t i = begin; i < all.size(); ++i) {
      all.x[i] += width * static_cast<float>(n % kRooms);
      all.y[i] += depth * static_cast<float>(n / kRooms);
    }
  }
  all.resize(count);
  return all;
}

bool isSame(const TriangleMesh& a, const TriangleMesh& b) {
  return a.positions == b.positions && a.normals == b.normals && a.colors == b.colors &&
         a.triangles == b.triangles;
}

int bigMesh(const Options& options) {
  const SurfelArrays surfels = copiesOf(loadMap(options.map), options.surfels);
  Stopwatch watch;
  const TriangleMesh mesh = surfelMesh(surfels, {});
  const double made_s = 1e-3 * watch.lapMs();
  const double peak_mb = peakMemoryMb();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  watch.lapMs();
  const bool same = isSame(mesh, surfelMesh(surfels, {}));
  const nlohmann::ordered_json out = {
      {"surfels", surfels.size()}, {"triangles", mesh.triangles.size()},
      {"time_s", made_s},          {"one_thread_s", 1e-3 * watch.lapMs()},
      {"peak_memory_mb", peak_mb}, {"one_thread_same", same}};
  std::cout << out.dump(2) << "\n";
  return 0;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) {
  pf::CommandLine app{"Time and memory of the mesh of many surfels.", "posefusion_big_mesh"};
  pf::Options options;
  app.addOption("map", options.map, "map.ply of a run")->required();
  app.addOption("--surfels", options.surfels, "of all copies")->check(pf::positive());
  return pf::runTool(app, argc, argv, [&] { return pf::bigMesh(options); });
}
