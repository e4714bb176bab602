// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/mapper.hpp"

#include <utility>

#include "mapper_state.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/stopwatch.hpp"

namespace pf {

/// Why the frame cannot follow the ones before; empty when it can.
std::string Mapper::State::defect(const StaticFrame& still) const {
  const RgbdFrame& input = still.frame;
  std::string text = defectOf(input);
  const auto isLikeDepth = [&](const cv::Mat& image, int type) {
    return image.type() == type && image.size() == input.depth.size();
  };
  const bool mask_fits = still.mask.empty() || isLikeDepth(still.mask, CV_8UC1);
  const bool depth_fits =
      still.input_depth.empty() || isLikeDepth(still.input_depth, input.depth.type());
  if (text.empty() && !(mask_fits && depth_fits)) {
    text = "the mask of people, or the depth with people, is not like the frame's depth";
  }
  if (text.empty() && sees_other_camera) {
    text = "the camera (" + describe(input.camera) + ") is not that of the map (" +
           describe(camera) + ")";
  }
  if (text.empty() && calibration) {
    const std::string wrong = misfit(*calibration, input.camera);
    if (!wrong.empty()) text = "the calibration of depth " + wrong;
  }
  if (text.empty() && input.stamp_ns <= last_stamp_ns) {
    text = "its stamp is not later than that of the frame before";
  }
  return text;
}

/// The place of a camera that is not the map's is not known.
TrackingState Mapper::State::state() const {
  return sees_other_camera ? TrackingState::lost : localiser.state();
}

Location Mapper::State::locate(const StaticFrame& input) {
  const std::int64_t stamp_ns = input.frame.stamp_ns;
  if (map.frame() >= 0) {
    const int where = localiser.fragment();
    MapRenderers render;
    render.model = [=](const Eigen::Isometry3d& T) { return modelFrom({where, T}); };
    render.view = [=](const Eigen::Isometry3d& T) -> const ModelView& {
      return viewFrom({where, T});
    };
    return localiser.locate(frame, stamp_ns, input.flow, input.forced, view, render,
                            robot.between(localiser.lastStamp(), stamp_ns));
  }
  const auto needed =
      config.tracking.min_view_fraction * static_cast<double>(frame.depth_m.total());
  if (frame.valid_pixels >= needed) {
    return localiser.begin(frame, stamp_ns, {kFirstFragment, T_map_start});
  }
  Location nowhere;
  nowhere.outcome = FrameOutcome::no_depth;
  nowhere.T_map_camera = T_map_start;
  return nowhere;
}

void Mapper::State::fuse(const StaticFrame& input, const Location& location) {
  // Colors of the map are those of its first exposure.
  const Brightness& b = location.tracking.brightness;
  FusionOptions options;
  options.fragment = location.fragment;
  options.may_remove_stable = !location.is_recent_return;
  options.gain = 1.0F / b.gain;
  options.offset = -b.offset / b.gain;
  if (!input.input_depth.empty() && !input.mask.empty()) {
    options.mask = input.mask;
    RgbdFrame with_people = input.frame;
    with_people.depth = input.input_depth;
    depthInMetres(with_people, config.frame.min_depth_m, config.frame.max_depth_m, input_depth_m);
    options.input_depth_m = input_depth_m;
  }
  fuser.fuse(frame, location.T_map_camera, map, options);
  showFrom(location.pose(), last_stamp_ns, true);
}

/// Follows a located frame that is not to be fused. `fill`: it fills in for the map where there is
/// none.
void Mapper::State::follow(const Location& location, bool fill) {
  endSearch();
  showFrom(location.pose(), last_stamp_ns, fill);
}

Mapper::Mapper(const Config& config) : state_(std::make_unique<State>(config)) {}
Mapper::~Mapper() = default;

FrameStatus Mapper::process(const StaticFrame& measured) {
  State& s = *state_;
  s.drawView();
  if (defectOf(measured.frame).empty()) {
    s.sees_other_camera = !s.view.empty() && !isSameCamera(s.camera, measured.frame.camera);
  }
  FrameStatus status = skip(measured.frame.stamp_ns, FrameOutcome::bad_input);
  status.detail = s.defect(measured);
  status.is_other_camera = s.sees_other_camera;
  if (!status.detail.empty()) return status;
  const StaticFrame input = s.corrected(measured);
  if (s.view.empty()) s.camera = input.frame.camera;
  const std::int64_t before_ns = std::exchange(s.last_stamp_ns, input.frame.stamp_ns);
  Stopwatch watch;
  s.frame.pace = s.pace_meter.add(s.last_stamp_ns);
  s.frame.assign(input.frame, input.mask, s.config.frame, s.sensor);
  const std::optional<MapPose> before = s.trackedPose();
  Location location = s.locate(input);
  s.checkRobot(location, before, before_ns);
  s.reckon(location, before, before_ns);
  s.countLostTime(location, before_ns);
  if (s.wantsFragment(input)) location = s.beginFragment();
  status.tracking_ms = watch.lapMs();
  s.question.reset();
  if (location.outcome == FrameOutcome::forced && location.located) {
    s.follow(location, true);
  } else if (location.outcome == FrameOutcome::fused && !s.may_change) {
    location.outcome = FrameOutcome::located;
    s.follow(location, false);
  } else if (location.outcome == FrameOutcome::fused) {
    // If it is back in a fragment whose place is not known, that is not to be found in itself.
    if (location.is_return) s.map_at_loss.reset();
    s.fuse(input, location);
    s.keep(input, location);
    s.askForFragment();
  } else if (location.state == TrackingState::lost) {
    s.askForPlace();
  }
  if (location.located) s.back_end.record(input.frame.stamp_ns, location.pose());
  status.fusion_ms = watch.lapMs();
  status.state = location.state;
  status.outcome = location.outcome;
  status.located = location.located && s.isPlaceKnown();
  status.fragment = location.fragment;
  status.detail = location.detail;
  status.T_map_camera = location.T_map_camera;
  status.tracking = location.tracking;
  status.covariance = location.covariance;
  if (!status.located) status.provisional = s.reckoning.pose();
  status.motion = location.motion;
  status.surfels = s.map.size();
  status.map_full = s.map.refused() > 0;
  return status;
}

void Mapper::setUse(MapUse use) {
  State& s = *state_;
  if (use == MapUse::localize_only && s.back_end.graph().keyframes().empty()) {
    throw InputError("there is no map to localise in: nothing was mapped");
  }
  s.may_change = use == MapUse::extend;
  if (!s.may_change) s.wanted = {};
}

const std::vector<KeyframeView>& Mapper::keyframeViews() const { return state_->views; }

const Brightness& Mapper::brightness() const { return state_->localiser.brightness(); }

const BackEnd& Mapper::backEnd() const { return state_->back_end; }

FrameStatus Mapper::skip(std::int64_t stamp_ns, FrameOutcome outcome) const {
  FrameStatus status;
  status.stamp_ns = stamp_ns;
  status.state = state_->state();
  status.outcome = outcome;
  status.T_map_camera =
      state_->map.frame() < 0 ? state_->T_map_start : state_->localiser.lastPose().T_map_camera;
  status.surfels = state_->map.size();
  status.fragment = state_->fragment();
  status.map_version = state_->back_end.graph().version();
  status.map_full = state_->map.refused() > 0;
  return status;
}

const SurfelMap& Mapper::map() const { return state_->map; }

const Pace& Mapper::pace() const { return state_->frame.pace; }

void Mapper::place(const Eigen::Isometry3d& T_world_map) { state_->T_world_map = T_world_map; }

const std::optional<Eigen::Isometry3d>& Mapper::placed() const { return state_->T_world_map; }

void Mapper::set(const TrackingConfig& tracking) {
  state_->config.tracking = tracking;
  state_->localiser.set(tracking);
}

std::size_t Mapper::add(const SurfelArrays& surfels) { return state_->map.add(surfels); }

void Mapper::reset(const Eigen::Isometry3d& T_map_camera) {
  State& s = *state_;
  s.map.clear();
  s.fuser.forget();
  s.T_world_map.reset();
  s.view = s.seen = ModelView();
  s.wanted_view.reset();
  s.T_map_uncorrected = Eigen::Isometry3d::Identity();
  s.constraints_are_old = s.calibration_is_asked = false;
  s.last_calibration.clear();
  s.localiser.reset();
  s.sees_other_camera = false;
  s.T_map_start = T_map_camera;
  s.last_stamp_ns = kBeforeAll;
  s.back_end = BackEnd(s.config.graph);
  s.question.reset();
  s.wanted = {};
  s.wanted_steps.clear();
  s.is_correcting = false;
  s.unswept.clear();
  s.keyframes_moved = s.place_is_asked = s.closer_is_old = false;
  s.may_change = true;
  s.views.clear();
  s.retired.clear();
  s.reckoning.reset();
  s.hint.reset();
  s.gravity = {};
  s.rooms.clear();
  s.next_room = 0;
  s.map_at_loss.reset();
  s.last_fragment = kFirstFragment;
  s.frames_to_place = 0;
  s.lost_s.reset();
  s.at_question = {};
  s.seen_at.reset();
}

}  // namespace pf
