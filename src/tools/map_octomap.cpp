// SPDX-License-Identifier: BSD-3-Clause
#include <octomap/OcTree.h>

#include <cmath>
#include <cstdio>
#include <memory>

#include "map_plans.hpp"
#include "map_surfels.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/grid/keyframe_rays.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/map/stable_surfels.hpp"

namespace pf {
namespace {

struct OctomapOptions {
  std::string file, output;
  double voxel_m = 0.05;
};

octomap::point3d pointOf(const Eigen::Vector3f& p) { return {p.x(), p.y(), p.z()}; }

/// Free along the rays of keyframes; occupied wherever there is a stable surfel, as rays that graze
/// a surface would wear it away.
void fill(const std::string& file, octomap::OcTree& tree) {
  const MapReader reader(file);
  const MapContent content = reader.content();
  const SurfelMap map = mapOf(reader, content, file);
  const Eigen::Isometry3d T_world_map = worldOf(content);
  const Eigen::Isometry3f T = T_world_map.cast<float>();
  forEachKeyframe(map, content.camera, content.keyframes, [&](const SeenPoints& seen) {
    octomap::Pointcloud cloud;
    for (const Eigen::Vector3f& p : seen.points) cloud.push_back(pointOf(T * p));
    tree.insertPointCloud(cloud, pointOf(T * seen.from), -1, true, true);
  });
  const SurfelArrays s = stableSurfels(map, T_world_map);
  if (s.size() == 0) throw InputError(file + ": has no stable surfels, expected some");
  for (std::size_t i = 0; i < s.size(); ++i) {
    tree.setNodeValue(octomap::point3d(s.x[i], s.y[i], s.z[i]), tree.getClampingThresMaxLog(),
                      true);
  }
  tree.updateInnerOccupancy();
  tree.prune();
}

void writeOctomap(const OctomapOptions& options) {
  requireEnding(options.output, {".bt"});
  octomap::OcTree tree(options.voxel_m);
  fill(options.file, tree);
  AtomicFile file(options.output);
  if (!tree.writeBinary(file.stream())) throw InputError(options.output + ": cannot be written");
  file.commit();
  std::printf("%s: %zu leaves of %g m and more\n", options.output.c_str(), tree.getNumLeafNodes(),
              options.voxel_m);
}

}  // namespace

void addOctomapCommand(CommandLine& app) {
  const auto options = std::make_shared<OctomapOptions>();
  CommandLine* const command = app.addCommand("octomap", "writes an octree of free and occupied");
  command->addOption("file", options->file, "map file, *.pfdb")->required();
  command->addOption("-o,--output", options->output, "*.bt")->required();
  command->addOption("--voxel", options->voxel_m, "side of the smallest leaf (m)")
      ->check(range(0.01, 10.0));
  command->does([options] { writeOctomap(*options); });
}

}  // namespace pf
