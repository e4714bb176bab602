// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/map_correction.hpp"

#include <algorithm>
#include <utility>

#include "posefusion/loop/dense_pairs.hpp"
#include "posefusion/map/deform.hpp"
#include "posefusion/map/layers.hpp"
#include "posefusion/map/tears.hpp"

namespace pf {
namespace {

constexpr double kMillimetre = 1e-3;

void correctViews(DepthImprovement& depth) {
  const cv::Size small(depth.step.camera.width, depth.step.camera.height);
  depth.corrector = DepthCorrector(depth.known.field, depth.frame_size);
  depth.distorter = DepthCorrector(depth.known.field.inverse(), small);
  depth.of_frames = DepthCorrector(depth.step.field, depth.frame_size);
  depth.of_views = DepthCorrector(depth.step.field, small);
  for (KeyframeView& view : depth.views) correctDepth(depth.of_views, view);
}

/// Poses were tracked with the depth that was wrong: without theirs, surfels that several keyframes
/// have seen would have no place that suits all.
void improve(DepthImprovement& depth, CorrectedMap& made) {
  correctViews(depth);
  std::vector<const KeyframeView*> seen;
  for (const KeyframeView& view : depth.views) seen.push_back(&view);
  GraphResult result = made.graph.remeasure(
      measurePairs(seen, made.graph.constraints(), depth.tracking, depth.step.sensor));
  depth.moves_keyframes = result.accepted;
  depth.step.keyframes = made.graph.keyframes();
  depth.step.motion = result.deformation;
  correctDepth(made.map, depth.step);
  made.graph.countCorrection();
  if (!result.accepted) return;
  ++made.closed.accepted;
  made.closed.deformations.push_back(std::move(result.deformation));
}

}  // namespace

double largestShiftM(const std::vector<Keyframe>& before, const std::vector<Keyframe>& after) {
  double largest = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Eigen::Vector3d from = before[i].T_map_camera.translation();
    largest = std::max(largest, (after[i].T_map_camera.translation() - from).norm());
  }
  return largest;
}

void correctDepth(DepthCorrector& corrector, KeyframeView& view) {
  view.depth_mm = corrector.likeInput(view.depth_mm, kMillimetre);
}

CorrectedMap prepare(MapCorrection correction) {
  const std::vector<Keyframe> keyframes = correction.graph.keyframes();
  CorrectedMap made{correction.number,
                    std::move(correction.graph),
                    {},
                    correction.map,
                    std::move(correction.map),
                    std::move(correction.depth),
                    std::move(correction.unswept),
                    {}};
  made.closed = made.graph.close(correction.loops);
  if (!correction.remeasured.empty()) {
    GraphResult result = made.graph.remeasure(correction.remeasured);
    if (result.accepted) made.closed.deformations.push_back(std::move(result.deformation));
    made.closed.accepted += result.accepted ? 1 : 0;
  }
  bool joins = false;
  for (const Deformation& deformation : made.closed.deformations) {
    deform(made.map, deformation);
    joins |= deformation.joins();
  }
  if (made.depth) improve(*made.depth, made);
  // What joins nothing and moves no keyframe so far lays no pass over another.
  made.lays_layers = joins || largestShiftM(keyframes, made.graph.keyframes()) > kLeastLayer_m;
  if (made.lays_layers) {
    const auto torn = tornBlocks(made.before, made.map, keyframes, made.graph.keyframes());
    made.swept.insert(made.swept.end(), torn.begin(), torn.end());
  }
  if (!made.swept.empty()) removeYoungerLayers(made.map, made.swept);
  made.retired = made.graph.retire();
  return made;
}

}  // namespace pf
