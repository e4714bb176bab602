// SPDX-License-Identifier: BSD-3-Clause
// How the mapper shows its map: to tracking, to the segmenter, and on request.
#include <algorithm>
#include <utility>

#include "mapper_state.hpp"
#include "posefusion/segmentation/segmenter.hpp"

namespace pf {
namespace {

// A guess that lies further from the last view than this sees too much that the view does not show.
constexpr double kSameViewShift_m = 0.15, kSameViewTurn_rad = 0.12;
// The view is drawn as far as frames are tracked, and a match beyond that may still be near enough.
constexpr float kMatchSigmas = 5.0F;

/// Not less far than the segmenter looks for people, whatever the range of the map: it finds a
/// person before a far wall by that wall.
RenderOptions viewOptions(const DepthSensor& sensor, int fragment) {
  const double range_m = sensor.max_depth_m;
  RenderOptions options;
  options.max_depth_m = std::max(
      kFarthestPerson_m, range_m + sensor.tolerance(static_cast<float>(range_m), kMatchSigmas));
  options.fragment = fragment;
  return options;
}

}  // namespace

/// The last view where it serves, else one of its own.
RenderedModel Mapper::State::modelFrom(const MapPose& pose) {
  const Eigen::Isometry3d step = view.T_map_camera.inverse() * pose.T_map_camera;
  if (view.fragment == pose.fragment && step.translation().norm() < kSameViewShift_m &&
      angleOf(step) < kSameViewTurn_rad) {
    return {model, view.T_map_camera};
  }
  model_elsewhere.assign(viewFrom(pose), sensor);
  return {model_elsewhere, pose.T_map_camera};
}

const ModelView& Mapper::State::viewFrom(const MapPose& pose) {
  renderer.render(map, frame.camera, pose.T_map_camera, viewOptions(sensor, pose.fragment),
                  elsewhere);
  return elsewhere;
}

/// Says what the view that tracking and the segmenter go by is to show.
void Mapper::State::showFrom(const MapPose& pose, std::int64_t stamp_ns, bool fill) {
  wanted_view = WantedView{pose, stamp_ns, fill};
}

void Mapper::State::drawView() {
  if (!wanted_view) return;
  const auto [pose, stamp_ns, fill] = *std::exchange(wanted_view, std::nullopt);
  renderer.render(map, frame.camera, pose.T_map_camera, viewOptions(sensor, pose.fragment), view);
  model.assign(view, sensor, fill ? &frame.levels[0] : nullptr);
  view.stamp_ns = stamp_ns;
  view.T_map_uncorrected = T_map_uncorrected;
  seen = view;
  seen.T_world_map = worldFromMap().value_or(bodyFromOptical());
  if (calibration) seen.depth_m = distorter.inMetres(view.depth_m, 1.0);
}

const ModelView& Mapper::view() const {
  state_->drawView();
  return state_->state() == TrackingState::lost ? state_->nothing : state_->seen;
}

ModelView Mapper::render(const PinholeCamera& camera, const Eigen::Isometry3d& T_map_camera) const {
  ModelView view;
  RenderOptions options;
  options.with_color = true;
  options.age = SurfelAge::all;
  SurfelRenderer().render(state_->map, camera, T_map_camera, options, view);
  return view;
}

}  // namespace pf
