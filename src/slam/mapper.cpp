// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/mapper.hpp"

#include <limits>

#include "posefusion/core/stopwatch.hpp"
#include "posefusion/map/fusion.hpp"
#include "posefusion/map/render.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "posefusion/tracking/rotation.hpp"
#include "posefusion/tracking/tracker.hpp"

namespace pf {

struct Mapper::State {
  explicit State(const Config& c) : config(c), map(c.map) {}

  Config config;
  TrackingState tracking_state = TrackingState::initializing;
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  int untrusted_in_a_row = 0;
  SurfelMap map;
  WorkingFrame frame;
  ModelView view;  ///< from T_map_camera
  ModelPyramid model;
  SmallImage previous;  ///< the last fused frame, coarsest level
  Fuser fuser;
  SurfelRenderer renderer;

  std::int64_t last_stamp_ns = std::numeric_limits<std::int64_t>::min();

  std::string defect(const RgbdFrame& input) const;
  FrameOutcome locate(TrackingResult& result);
  FrameOutcome judge(const TrackingResult& result) const;
  void fuse(const Eigen::Isometry3d& T);
};

std::string_view name(TrackingState state) {
  switch (state) {
    case TrackingState::initializing:
      return "initializing";
    case TrackingState::tracking:
      return "tracking";
    case TrackingState::lost:
      return "lost";
  }
  return "unknown";
}

std::string_view name(FrameOutcome outcome) {
  switch (outcome) {
    case FrameOutcome::fused:
      return "fused";
    case FrameOutcome::bad_input:
      return "bad_input";
    case FrameOutcome::blurred:
      return "blurred";
    case FrameOutcome::no_depth:
      return "no_depth";
    case FrameOutcome::not_converged:
      return "not_converged";
    case FrameOutcome::few_inliers:
      return "few_inliers";
    case FrameOutcome::jumped:
      return "jumped";
  }
  return "unknown";
}

std::string reasonOf(const FrameStatus& status) {
  if (status.outcome == FrameOutcome::fused) return {};
  return std::string(name(status.outcome)) + (status.detail.empty() ? "" : ": " + status.detail);
}

/// Why the frame cannot follow the ones before; empty when it can.
std::string Mapper::State::defect(const RgbdFrame& input) const {
  std::string text = defectOf(input);
  if (text.empty() && !view.empty() && input.camera.shrunk(config.frame.shrink) != view.camera) {
    text = "the camera or the image size is not that of the frames before";
  }
  if (text.empty() && input.stamp_ns <= last_stamp_ns) {
    text = "its stamp is not later than that of the frame before";
  }
  return text;
}

/// Where is the frame in the map? `fused` means: trust it.
FrameOutcome Mapper::State::locate(TrackingResult& result) {
  result.T_map_camera = T_map_camera;
  const auto needed =
      config.tracking.min_valid_fraction * static_cast<double>(frame.depth_m.total());
  if (frame.valid_pixels < needed) return FrameOutcome::no_depth;
  if (map.frame() < 0) {
    result.converged = true;
    return FrameOutcome::fused;
  }
  const FrameLevel& coarse = frame.levels[kLevels - 1];
  Eigen::Isometry3d T_view_camera = Eigen::Isometry3d::Identity();
  if (config.tracking.rotation_prealignment) {
    T_view_camera.linear() =
        alignRotation(previous, {coarse.intensity, coarse.still}, coarse.camera).transpose();
  }
  result = track(frame, model, view.T_map_camera, T_view_camera, config.tracking);
  return judge(result);
}

FrameOutcome Mapper::State::judge(const TrackingResult& result) const {
  const TrackingConfig& c = config.tracking;
  if (result.candidates < c.min_valid_fraction * static_cast<double>(frame.depth_m.total())) {
    return FrameOutcome::few_inliers;
  }
  if (!result.converged) return FrameOutcome::not_converged;
  if (result.inliers < c.min_inlier_fraction * result.candidates) return FrameOutcome::few_inliers;
  const Vector6d motion = logSe3(T_map_camera.inverse() * result.T_map_camera);
  // Frames that were dropped or not trusted leave the camera more time to move.
  const double steps = 1.0 + untrusted_in_a_row;
  if (motion.head<3>().norm() > c.max_translation_m * steps ||
      motion.tail<3>().norm() > c.max_rotation_rad * steps) {
    return FrameOutcome::jumped;
  }
  return FrameOutcome::fused;
}

void Mapper::State::fuse(const Eigen::Isometry3d& T) {
  T_map_camera = T;
  fuser.fuse(frame, T, map);
  renderer.render(map, frame.camera, T, RenderOptions{}, view);
  view.stamp_ns = last_stamp_ns;
  model.assign(view);
  const FrameLevel& coarse = frame.levels[kLevels - 1];
  coarse.intensity.copyTo(previous.intensity);
  coarse.still.copyTo(previous.still);
}

Mapper::Mapper(const Config& config) : state_(std::make_unique<State>(config)) {}
Mapper::~Mapper() = default;

FrameStatus Mapper::process(const RgbdFrame& frame, const cv::Mat& mask) {
  State& s = *state_;
  FrameStatus status = skip(frame.stamp_ns, FrameOutcome::bad_input);
  status.detail = s.defect(frame);
  if (!status.detail.empty()) return status;
  s.last_stamp_ns = frame.stamp_ns;
  Stopwatch watch;
  s.frame.assign(frame, mask, s.config.frame);
  status.outcome = s.locate(status.tracking);
  status.tracking_ms = watch.lapMs();
  if (status.outcome == FrameOutcome::fused) {
    s.untrusted_in_a_row = 0;
    s.tracking_state = TrackingState::tracking;
    s.fuse(status.tracking.T_map_camera);
  } else if (++s.untrusted_in_a_row >= s.config.tracking.lost_after_frames &&
             s.tracking_state == TrackingState::tracking) {
    s.tracking_state = TrackingState::lost;
  }
  status.fusion_ms = watch.lapMs();
  status.state = s.tracking_state;
  status.T_map_camera = s.T_map_camera;
  status.surfels = s.map.surfels().size();
  status.map_full = s.map.refused() > 0;
  return status;
}

FrameStatus Mapper::skip(std::int64_t stamp_ns, FrameOutcome outcome) const {
  FrameStatus status;
  status.stamp_ns = stamp_ns;
  status.state = state_->tracking_state;
  status.outcome = outcome;
  status.T_map_camera = state_->T_map_camera;
  status.surfels = state_->map.surfels().size();
  status.map_full = state_->map.refused() > 0;
  return status;
}

const ModelView& Mapper::view() const { return state_->view; }

ModelView Mapper::render(const PinholeCamera& camera, const Eigen::Isometry3d& T_map_camera) const {
  ModelView view;
  RenderOptions options;
  options.with_color = true;
  options.only_active = false;
  SurfelRenderer().render(state_->map, camera, T_map_camera, options, view);
  return view;
}

const SurfelMap& Mapper::map() const { return state_->map; }

void Mapper::reset(const Eigen::Isometry3d& T_map_camera) {
  State& s = *state_;
  s.map.clear();
  s.view = ModelView();
  s.T_map_camera = T_map_camera;
  s.tracking_state = TrackingState::initializing;
  s.untrusted_in_a_row = 0;
  s.last_stamp_ns = std::numeric_limits<std::int64_t>::min();
}

}  // namespace pf
