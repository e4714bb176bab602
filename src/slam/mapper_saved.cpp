// SPDX-License-Identifier: BSD-3-Clause
// A map as a file has it, taken up and handed out.
#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "mapper_state.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/map/depth_step.hpp"

namespace pf {
namespace {

/// A picture of a session with another `frame.shrink`, in the size of this one.
void fit(KeyframeView& view, const cv::Size& size) {
  if (view.intensity.size() == size) return;
  const int smooth = size.width < view.intensity.cols ? cv::INTER_AREA : cv::INTER_LINEAR;
  cv::resize(view.intensity, view.intensity, size, 0, 0, smooth);
  // Depths of two surfaces have no mean.
  cv::resize(view.depth_mm, view.depth_mm, size, 0, 0, cv::INTER_NEAREST_EXACT);
}

}  // namespace

void Mapper::load(SavedMap saved, MapUse use) {
  if (saved.frame < 0 || saved.keyframes.empty()) {
    throw InputError("has no keyframe: nothing was mapped");
  }
  State& s = *state_;
  PoseGraph graph(s.config.graph, std::move(saved.keyframes), std::move(saved.constraints),
                  saved.graph_version);
  reset();
  s.map.restore(saved.surfels, saved.frame);
  s.T_world_map = saved.T_world_map;
  s.back_end = BackEnd(std::move(graph), std::move(saved.frames));
  s.camera = saved.camera;
  s.frame.camera = saved.camera.shrunk(shrinkFor(s.config.frame, saved.camera.fx));
  for (KeyframeView& view : saved.views) {
    fit(view, {s.frame.camera.width, s.frame.camera.height});
    view.camera = s.frame.camera;
    s.views.push_back(std::move(view));
  }
  if (saved.calibration && !s.config.calibration.corrects()) {
    throw InputError(
        "its depth was corrected by a calibration, and calibration.mode is none: "
        "expected learn or frozen");
  }
  s.may_change = use == MapUse::extend;
  s.closer_is_old = true;
  if (saved.calibration) {
    s.use(std::move(saved.calibration));
  } else if (s.calibration) {  // the map is of depth as it was measured
    const DepthField& step = s.calibration->field;
    correctDepth(s.map, {step, s.frame.camera, s.back_end.graph().keyframes(), s.sensor,
                         s.calibration->left_per_m});
    DepthCorrector corrector(step);
    for (KeyframeView& view : s.views) correctDepth(corrector, view);
    s.depthHasChanged(corrector);
    ++s.depth_version;  // the keyframes' pictures have changed, and with them what a file has
    s.constraints_are_old = true;
  }
  const std::vector<MapPose> poses = s.back_end.keyframePoses();
  for (const MapPose& pose : poses) s.last_fragment = std::max(s.last_fragment, pose.fragment);
  s.seek(poses.back(), saved.brightness);
}

SavedMap Mapper::saved(const PinholeCamera& camera) const {
  const State& s = *state_;
  const PoseGraph& graph = s.back_end.graph();
  SavedMap saved;
  saved.camera = camera;
  saved.brightness = s.localiser.brightness();
  saved.surfels = s.map.parts();
  saved.frame = s.map.frame();
  saved.T_world_map = s.worldFromMap();
  saved.keyframes = graph.keyframes();
  saved.constraints = graph.keptConstraints();
  saved.graph_version = graph.version();
  saved.frames = s.back_end.frames();
  saved.views = s.views;
  saved.calibration = s.calibration;
  return saved;
}

}  // namespace pf
