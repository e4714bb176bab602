// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "evaluate.hpp"
#include "posefusion/evaluation/mesh_check.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/evaluation/seen_surface.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/mesh_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/run/mask_folders.hpp"
#include "posefusion/run/sequence_facts.hpp"
#include "posefusion_ros/bags/bag_source.hpp"
#include "true_surface.hpp"

namespace pf {
namespace {

constexpr std::size_t kEvery = 15;  // frames of the run, so that three views are three places

/// What the frames that the run has poses of have seen.
SurfaceSamples seenWell(const std::string& sequence, const std::vector<PosePair>& pairs,
                        const SurfaceSamples& truth) {
  std::map<std::int64_t, Eigen::Isometry3d> views;
  for (std::size_t i = 0; i < pairs.size(); i += kEvery) {
    views[pairs[i].estimate.stamp_ns] = pairs[i].truth.T_world_camera;
  }
  SeenSurface seen(truth, DepthSensor());
  const auto source = posefusion_ros::openInput(sequence, {});
  while (const auto next = source->next()) {
    const auto pose = views.find(next->frame.stamp_ns);
    if (!next->defect.empty() || pose == views.end()) continue;
    seen.add(next->frame, loadMask(sequence + "/mask", next->frame.stamp_ns), pose->second);
  }
  return seen.seenWell();
}

void print(const MeshScore& score, double surfel_coverage) {
  std::printf("triangles                %zu, %.1f m2\n", score.triangles, score.area_m2);
  std::printf("to the true surface      %.1f mm median, %.1f mm 95 %% (of its area)\n",
              1e3 * score.median_m, 1e3 * score.p95_m);
  std::printf("farther than %.0f cm from the centre of every surfel: %zu\n", 100 * kInvented_m,
              score.invented);
  std::printf(
      "covers                   %.2f %% of the surface seen by %d views (surfels: %.2f %%)\n",
      100 * score.coverage(), SeenSurface::kViews, 100 * surfel_coverage);
}

}  // namespace

void evaluateMesh(const SurfaceQuestion& question) {
  const TriangleMesh mesh = loadMesh(question.surface);
  const SurfelArrays surfels = loadMap(question.run + "/map.ply");
  const SurfaceSamples truth = trueSurface(question.sequence);
  const auto pairs = matchPoses(loadSequenceTruth(question.sequence).trajectory,
                                loadTrajectory(question.run + "/trajectory.txt"));
  const Eigen::Isometry3d T_truth_map = alignPoses(pairs);
  const SurfaceSamples seen = seenWell(question.sequence, pairs, truth);
  const MeshScore score = checkMesh(mesh, surfels, T_truth_map, truth, seen);
  const double surfel_coverage = shareCovered(seen, surfels, T_truth_map);
  if (!question.json) return print(score, surfel_coverage);
  const nlohmann::ordered_json out = {
      {"triangles", score.triangles}, {"area_m2", score.area_m2},
      {"median_m", score.median_m},   {"p95_m", score.p95_m},
      {"invented", score.invented},   {"seen", score.seen},
      {"coverage", score.coverage()}, {"surfel_coverage", surfel_coverage}};
  std::cout << out.dump(2) << "\n";
}

}  // namespace pf
