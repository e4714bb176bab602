// SPDX-License-Identifier: BSD-3-Clause
// posefusion_map: looks into a map file.
#include <algorithm>
#include <cstdio>
#include <set>

#include "map_calibration.hpp"
#include "map_merge.hpp"
#include "map_mesh.hpp"
#include "map_plans.hpp"
#include "map_refine.hpp"
#include "map_surfels.hpp"
#include "map_view.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/io/map_database.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/map_repair.hpp"
#include "posefusion/io/ply.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/run/plan_picture.hpp"
#include "tool.hpp"

namespace pf {
namespace {

std::size_t fragmentsOf(const MapContent& content) {
  std::set<int> fragments;
  for (const Keyframe& k : content.keyframes) fragments.insert(k.fragment);
  return fragments.size();
}

void printInfo(const std::string& file) {
  const MapReader reader(file);
  const MapContent content = reader.content();
  const MapCounts counts = reader.counts();
  const auto loops = std::count_if(content.constraints.begin(), content.constraints.end(),
                                   [](const auto& c) { return c.kind == ConstraintKind::loop; });
  std::printf("file         %.1f MB\n", 1e-6 * static_cast<double>(counts.bytes));
  std::printf("camera       %d x %d, fx %.2f fy %.2f cx %.2f cy %.2f\n", content.camera.width,
              content.camera.height, content.camera.fx, content.camera.fy, content.camera.cx,
              content.camera.cy);
  std::printf("frames       %zu with a pose, %d fused\n", content.frames.size(), content.frame + 1);
  if (!content.frames.empty()) {
    std::printf("time         %s to %s\n", formatStamp(content.frames.front().stamp_ns).c_str(),
                formatStamp(content.frames.back().stamp_ns).c_str());
  }
  std::printf("surfels      %zu in %zu blocks\n", counts.surfels, counts.blocks);
  const auto retired = std::count_if(content.keyframes.begin(), content.keyframes.end(),
                                     [](const Keyframe& k) { return k.isRetired(); });
  std::printf("keyframes    %zu in %zu fragments, %td retired, %zu with images\n",
              content.keyframes.size(), fragmentsOf(content), retired, counts.images);
  std::printf("constraints  %zu, of them %td loops\n", content.constraints.size(), loops);
  std::printf("corrections  %d\n", content.graph_version);
  printCalibration(content, file);
  std::size_t bytes = 0;
  for (const auto& [name, data] : content.blobs) bytes += data.size();
  std::printf("blobs        %zu, %zu bytes\n", content.blobs.size(), bytes);
}

/// Reads all there is; whatever is wrong or missing throws.
void check(const std::string& file) {
  const MapReader reader(file);
  const MapContent content = reader.content();
  const std::size_t surfels = surfelsIn(reader.surfels());
  for (const Keyframe& k : content.keyframes) reader.images(k.id);
  if (!reader.missing().empty()) {
    throw InputError(reader.missing() + "; there are " + std::to_string(content.frames.size()) +
                     " frames, " + std::to_string(content.keyframes.size()) + " keyframes and " +
                     std::to_string(surfels) + " surfels");
  }
  std::printf("%s: whole: %zu surfels, %zu keyframes, %zu frames\n", file.c_str(), surfels,
              content.keyframes.size(), content.frames.size());
}

/// Succeeds also where something is lost: the new file is whole.
void repair(const std::string& file, const std::string& repaired) {
  const MapRepair repair = repairMap(file, repaired);
  std::printf("%s: %zu surfels in %zu blocks, %zu keyframes, %zu with images, %zu frames\n",
              repaired.c_str(), repair.kept.surfels, repair.kept.blocks, repair.keyframes,
              repair.kept.images, repair.frames);
  for (const std::string& lost : repair.lost) std::printf("lost: %s\n", lost.c_str());
  if (repair.lost.empty()) std::printf("nothing is lost\n");
}

/// The poses of all frames of the first fragment, as the graph has them now, in the order of their
/// stamps.
Trajectory trajectoryOf(const MapContent& content) {
  Trajectory trajectory;
  for (const FrameRecord& frame : content.frames) {
    const auto keyframe = static_cast<std::size_t>(frame.pose.keyframe);
    if (content.keyframes[keyframe].fragment != kFirstFragment) continue;
    trajectory.push_back({frame.stamp_ns, poseOf(frame.pose, content.keyframes)});
  }
  std::stable_sort(trajectory.begin(), trajectory.end(),
                   [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
  return trajectory;
}

void exportKeyframes(const MapReader& reader, const MapContent& content,
                     const std::string& folder) {
  makeFolder(folder);
  for (const Keyframe& k : content.keyframes) {
    const KeyframeImages images = reader.images(k.id);
    if (images.grey.empty()) continue;
    const std::string name = folder + "/" + formatStamp(k.stamp_ns);
    savePng(name + "_grey.png", images.grey);
    savePng(name + "_depth.png", images.depth_mm);
  }
}

void exportAll(const std::string& file, const std::string& folder) {
  const MapReader reader(file);
  const MapContent content = reader.content();
  const Eigen::Isometry3d T_world_map = worldOf(content);
  makeFolder(folder);
  const std::size_t stable =
      saveMap(folder + "/map.ply", mapOf(reader, content, file), T_world_map);
  const Trajectory trajectory = inWorld(T_world_map, trajectoryOf(content));
  saveTrajectory(folder + "/trajectory.txt", trajectory, "poses of the camera in the map (z up)");
  exportKeyframes(reader, content, folder + "/keyframes");
  if (!trajectory.empty()) {
    Plan plan;
    plan.surface = loadPoints(folder + "/map.ply");
    plan.estimate = trajectory;
    plan.title = std::to_string(stable) + " surfels, " + std::to_string(content.keyframes.size()) +
                 " keyframes";
    savePng(folder + "/plan.png", drawPlan(plan));
  }
  std::printf("%s: %zu stable surfels, %zu poses, %zu keyframes\n", folder.c_str(), stable,
              trajectory.size(), content.keyframes.size());
}

int lookIntoMap(int argc, char** argv) {
  CommandLine app{"Looks into a map file of posefusion without changing it, or mends it in a copy.",
                  "posefusion_map"};
  std::string file, out;
  const auto command = [&](const char* name, const char* help) {
    CommandLine* added = app.addCommand(name, help);
    added->addOption("file", file, "map file, *.pfdb")->required();
    return added;
  };
  const auto output = [&](CommandLine* of, const char* help) {
    of->addOption("-o,--output", out, help)->required();
  };
  command("info", "prints what is in it")->does([&] { printInfo(file); });
  command("check", "reads all of it; exit code 1 when it is damaged")->does([&] { check(file); });
  CommandLine* const exporting =
      command("export", "writes map.ply trajectory.txt keyframes/ plan.png");
  output(exporting, "folder to write into");
  exporting->does([&] { exportAll(file, out); });
  CommandLine* const repairing =
      command("repair", "writes what can be read of a damaged map into a new file");
  output(repairing, "the new file");
  repairing->does([&] { repair(file, out); });
  std::string picture;
  CommandLine* const calibrating =
      command("calibration", "writes what its depth was corrected by into a calibration file");
  output(calibrating, "the calibration file");
  calibrating->addOption("--picture", picture, "PNG of the field");
  calibrating->does([&] { exportCalibration(file, out, picture); });
  CommandLine* const refining =
      command("refine", "aligns all keyframes that see the same surface, into a new file");
  output(refining, "the new file");
  refining->does([&] { refineMap(file, out); });
  std::string second;
  CommandLine* const merging =
      command("merge", "makes one map of two that know a place in common, in a new file");
  merging->addOption("second", second, "map file that comes into the coordinates of the first")
      ->required();
  output(merging, "the new file");
  merging->does([&] { mergeMaps(file, second, out); });
  addMeshCommand(app);
  addGridCommand(app);
  addPlanCommand(app);
  addOctomapCommand(app);
  addCloudCommand(app);
  addViewCommand(app);
  return runTool(app, argc, argv, [&] {
    app.act();
    return 0;
  });
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) { return pf::lookIntoMap(argc, argv); }
