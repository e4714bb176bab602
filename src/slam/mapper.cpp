// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/mapper.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/core/stopwatch.hpp"
#include "posefusion/map/deform.hpp"
#include "posefusion/map/fusion.hpp"
#include "posefusion/map/render.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "posefusion/slam/localiser.hpp"

namespace pf {
namespace {

constexpr std::int64_t kBeforeAll = std::numeric_limits<std::int64_t>::min();
// A guess that lies further from the last view than this sees too much that the view does not show.
constexpr double kSameViewShift_m = 0.15, kSameViewTurn_rad = 0.12;
// Neither tracking nor the segmenter looks at anything farther than 8 m.
const RenderOptions kViewOptions = {false, false, SurfelAge::active, 8.0};
// A camera anywhere in a loaded map is looked for around keyframes so far from each other: a search
// reaches 0.9 m each way. So many of them at once, in turns, that an answer comes soon.
constexpr double kRoomSide_m = 1.0;
constexpr std::size_t kRoomsAtOnce = 4;

/// Poses from which a search reaches around all of these; the last ones first.
std::vector<Eigen::Isometry3d> spreadOut(const std::vector<Eigen::Isometry3d>& poses) {
  std::vector<Eigen::Isometry3d> chosen;
  for (auto pose = poses.rbegin(); pose != poses.rend(); ++pose) {
    const auto near = [&](const Eigen::Isometry3d& other) {
      return (other.translation() - pose->translation()).norm() < kRoomSide_m;
    };
    if (std::none_of(chosen.begin(), chosen.end(), near)) chosen.push_back(*pose);
  }
  return chosen;
}

}  // namespace

struct Mapper::State {
  explicit State(const Config& c)
      : config(c), map(c.map), localiser(c.tracking), back_end(c.graph) {}

  Config config;
  SurfelMap map;
  Localiser localiser;
  Eigen::Isometry3d T_map_start = Eigen::Isometry3d::Identity();
  WorkingFrame frame;
  ModelView view, elsewhere;  ///< from the last trusted pose, from another guess
  ModelPyramid model, model_elsewhere;
  const ModelView nothing;
  Fuser fuser;
  SurfelRenderer renderer;
  std::int64_t last_stamp_ns = kBeforeAll;
  BackEnd back_end;
  std::optional<LoopQuestion> question;
  bool keyframes_moved = false;          ///< since the last question
  std::vector<KeyframeView> views;       ///< of the keyframes
  bool closer_is_old = false;            ///< does not know yet of the map that was loaded
  bool may_change = true;                ///< the map
  std::vector<Eigen::Isometry3d> rooms;  ///< of a loaded map until it is found: where to look
  std::size_t next_room = 0;
  // Of the search for a lost camera.
  std::shared_ptr<const SurfelMap> map_at_loss;
  Eigen::Isometry3d T_reckoned_at_question = Eigen::Isometry3d::Identity();
  bool place_is_asked = false, place_is_stale = false;

  std::string defect(const StaticFrame& input) const;
  RenderedModel modelFrom(const Eigen::Isometry3d& T);
  Location locate(const StaticFrame& input);
  void fuse(const StaticFrame& input, const Location& location);
  void follow(const Location& location);
  void showFrom(const Eigen::Isometry3d& T_map_camera, bool fill);
  void keep(const StaticFrame& input, const Location& location);
  void askForPlace();
  void correct(const std::vector<LoopConstraint>& loops);
};

/// Why the frame cannot follow the ones before; empty when it can.
std::string Mapper::State::defect(const StaticFrame& still) const {
  const RgbdFrame& input = still.frame;
  std::string text = defectOf(input);
  if (text.empty() && !still.in_map_mask.empty() &&
      (still.in_map_mask.type() != CV_8UC1 || still.in_map_mask.size() != input.depth.size() ||
       still.input_depth.type() != input.depth.type() ||
       still.input_depth.size() != input.depth.size())) {
    text = "the mask of people in the map, or the depth with people, is not like the frame's depth";
  }
  if (text.empty() && !view.empty() && input.camera.shrunk(config.frame.shrink) != view.camera) {
    text = "the camera or the image size is not that of the frames before";
  }
  if (text.empty() && input.stamp_ns <= last_stamp_ns) {
    text = "its stamp is not later than that of the frame before";
  }
  return text;
}

/// The last view where it serves, else one of its own.
RenderedModel Mapper::State::modelFrom(const Eigen::Isometry3d& T) {
  const Eigen::Isometry3d step = view.T_map_camera.inverse() * T;
  if (step.translation().norm() < kSameViewShift_m &&
      logSo3(step.linear()).norm() < kSameViewTurn_rad) {
    return {model, view.T_map_camera};
  }
  renderer.render(map, frame.camera, T, kViewOptions, elsewhere);
  model_elsewhere.assign(elsewhere);
  return {model_elsewhere, T};
}

Location Mapper::State::locate(const StaticFrame& input) {
  const std::int64_t stamp_ns = input.frame.stamp_ns;
  if (map.frame() >= 0) {
    return localiser.locate(frame, stamp_ns, input.flow, input.forced, view,
                            [this](const Eigen::Isometry3d& T) { return modelFrom(T); });
  }
  const auto needed =
      config.tracking.min_valid_fraction * static_cast<double>(frame.depth_m.total());
  if (frame.valid_pixels >= needed) return localiser.begin(frame, stamp_ns, T_map_start);
  Location nowhere;
  nowhere.outcome = FrameOutcome::no_depth;
  nowhere.T_map_camera = T_map_start;
  return nowhere;
}

void Mapper::State::fuse(const StaticFrame& input, const Location& location) {
  // Colors of the map are those of its first exposure.
  const Brightness& b = location.tracking.brightness;
  FusionOptions options;
  options.may_remove_stable = !location.is_recent_return;
  options.gain = 1.0F / b.gain;
  options.offset = -b.offset / b.gain;
  if (!input.in_map_mask.empty()) {
    options.person_mask = input.in_map_mask;
    RgbdFrame with_people = input.frame;
    with_people.depth = input.input_depth;
    depthInMetres(with_people, config.frame.min_depth_m, config.frame.max_depth_m,
                  options.input_depth_m);
  }
  fuser.fuse(frame, location.T_map_camera, map, options);
  showFrom(location.T_map_camera, true);
  view.stamp_ns = last_stamp_ns;
}

/// Where a frame was believed that is not to be fused.
void Mapper::State::follow(const Location& location) {
  map_at_loss.reset();
  rooms.clear();
  showFrom(location.T_map_camera, false);
  view.stamp_ns = last_stamp_ns;
}

/// Renders the view that tracking and the segmenter go by. `fill`: the frame was fused there.
void Mapper::State::showFrom(const Eigen::Isometry3d& T_map_camera, bool fill) {
  renderer.render(map, frame.camera, T_map_camera, kViewOptions, view);
  model.assign(view, fill ? &frame.levels[0] : nullptr);
}

/// Hands a fused frame to the graph; a new keyframe is a question to the loop closer.
void Mapper::State::keep(const StaticFrame& input, const Location& location) {
  map_at_loss.reset();
  rooms.clear();
  FusedFrame fused;
  fused.stamp_ns = last_stamp_ns;
  fused.map_frame = map.frame();
  fused.T_map_camera = location.T_map_camera;
  fused.covariance = location.tracking.covariance;
  fused.is_return = location.is_return;
  const int id = back_end.add(fused);
  if (id < 0) return;
  const bool nobody = input.mask.empty() || cv::countNonZero(input.mask) == 0;
  views.push_back(keyframeView(frame, id, location.T_map_camera, nobody));
  if (!config.loop.enabled) return;
  question.emplace();
  if (std::exchange(closer_is_old, false)) {
    question->known.emplace(views.begin(), views.end() - 1);
    keyframes_moved = true;
  }
  if (std::exchange(keyframes_moved, false)) {
    question->corrected = back_end.keyframePoses();
    question->corrected.pop_back();
  }
  question->keyframe = views.back();
}

/// Lost: asks where this frame is, unless the answer for one before is still to come.
void Mapper::State::askForPlace() {
  const double pixels = static_cast<double>(frame.depth_m.total());
  if (!config.loop.enabled || place_is_asked ||
      frame.valid_pixels < config.tracking.min_valid_fraction * pixels) {
    return;
  }
  if (!map_at_loss) map_at_loss = std::make_shared<const SurfelMap>(map);
  question.emplace();
  PlaceQuestion place{copyOf(frame), map_at_loss, localiser.lastPose()};
  for (std::size_t i = 0; i < std::min(kRoomsAtOnce, rooms.size()); ++i) {
    place.elsewhere.push_back(rooms[next_room++ % rooms.size()]);
  }
  question->place = std::make_shared<const PlaceQuestion>(std::move(place));
  T_reckoned_at_question = localiser.reckonedPose();
  place_is_asked = true;
  place_is_stale = false;
}

void Mapper::State::correct(const std::vector<LoopConstraint>& loops) {
  const GraphResult result = back_end.close(loops);
  if (!result.accepted || result.deformation.isIdentity()) return;
  const Eigen::Isometry3d T_new_old = result.deformation.at(map.frame());
  deform(map, result.deformation);
  localiser.move(T_new_old);
  const bool is_fused = view.stamp_ns == last_stamp_ns;
  showFrom(T_new_old * view.T_map_camera, is_fused);
  keyframes_moved = true;
  map_at_loss.reset();
  place_is_stale = true;
}

Mapper::Mapper(const Config& config) : state_(std::make_unique<State>(config)) {}
Mapper::~Mapper() = default;

FrameStatus Mapper::process(const StaticFrame& input) {
  State& s = *state_;
  FrameStatus status = skip(input.frame.stamp_ns, FrameOutcome::bad_input);
  status.detail = s.defect(input);
  if (!status.detail.empty()) return status;
  s.last_stamp_ns = input.frame.stamp_ns;
  Stopwatch watch;
  s.frame.assign(input.frame, input.mask, s.config.frame);
  const Location location = s.locate(input);
  status.tracking_ms = watch.lapMs();
  s.question.reset();
  if (location.outcome == FrameOutcome::fused && !s.may_change) {
    s.follow(location);
  } else if (location.outcome == FrameOutcome::fused) {
    s.fuse(input, location);
    s.keep(input, location);
  } else if (location.state == TrackingState::lost) {
    s.askForPlace();
  }
  if (location.located) s.back_end.record(input.frame.stamp_ns, location.T_map_camera);
  status.fusion_ms = watch.lapMs();
  status.state = location.state;
  status.outcome = location.outcome;
  status.located = location.located;
  status.detail = location.detail;
  status.T_map_camera = location.T_map_camera;
  status.tracking = location.tracking;
  status.motion = location.motion;
  status.surfels = s.map.size();
  status.map_full = s.map.refused() > 0;
  return status;
}

std::optional<LoopQuestion> Mapper::takeQuestion() {
  return std::exchange(state_->question, std::nullopt);
}

void Mapper::take(const LoopAnswer& answer) {
  State& s = *state_;
  if (answer.asked_for_place) {
    s.place_is_asked = false;
    if (answer.place && !s.place_is_stale) {
      s.localiser.suggest(answer.place->alignment.T_map_camera, s.T_reckoned_at_question);
    }
  }
  if (!answer.loops.empty()) s.correct(answer.loops);
}

void Mapper::load(SavedMap saved, MapUse use) {
  if (saved.frame < 0 || saved.keyframes.empty()) {
    throw InputError("has no keyframe: nothing was mapped");
  }
  State& s = *state_;
  PoseGraph graph(s.config.graph, std::move(saved.keyframes), std::move(saved.constraints),
                  saved.graph_version);
  reset();
  s.map.restore(saved.surfels, saved.frame);
  s.back_end = BackEnd(std::move(graph), std::move(saved.frames));
  s.frame.camera = saved.camera.shrunk(s.config.frame.shrink);
  for (KeyframeView& view : saved.views) {
    if (view.intensity.size() != cv::Size(s.frame.camera.width, s.frame.camera.height)) continue;
    view.camera = s.frame.camera;
    s.views.push_back(std::move(view));
  }
  s.may_change = use == MapUse::extend;
  s.closer_is_old = true;
  const std::vector<Eigen::Isometry3d> poses = s.back_end.keyframePoses();
  s.rooms = spreadOut(poses);
  s.localiser.beginLost(poses.back(), saved.brightness);
  s.showFrom(poses.back(), false);
}

const std::vector<KeyframeView>& Mapper::keyframeViews() const { return state_->views; }

const Brightness& Mapper::brightness() const { return state_->localiser.brightness(); }

const BackEnd& Mapper::backEnd() const { return state_->back_end; }

FrameStatus Mapper::skip(std::int64_t stamp_ns, FrameOutcome outcome) const {
  FrameStatus status;
  status.stamp_ns = stamp_ns;
  status.state = state_->localiser.state();
  status.outcome = outcome;
  status.T_map_camera =
      state_->map.frame() < 0 ? state_->T_map_start : state_->localiser.lastPose();
  status.surfels = state_->map.size();
  status.map_version = state_->back_end.graph().version();
  status.map_full = state_->map.refused() > 0;
  return status;
}

const ModelView& Mapper::view() const {
  return state_->localiser.state() == TrackingState::lost ? state_->nothing : state_->view;
}

ModelView Mapper::render(const PinholeCamera& camera, const Eigen::Isometry3d& T_map_camera) const {
  ModelView view;
  RenderOptions options;
  options.with_color = true;
  options.age = SurfelAge::all;
  SurfelRenderer().render(state_->map, camera, T_map_camera, options, view);
  return view;
}

const SurfelMap& Mapper::map() const { return state_->map; }

std::size_t Mapper::add(const SurfelArrays& surfels) { return state_->map.add(surfels); }

void Mapper::reset(const Eigen::Isometry3d& T_map_camera) {
  State& s = *state_;
  s.map.clear();
  s.view = ModelView();
  s.localiser.reset();
  s.T_map_start = T_map_camera;
  s.last_stamp_ns = kBeforeAll;
  s.back_end = BackEnd(s.config.graph);
  s.question.reset();
  s.keyframes_moved = s.place_is_asked = s.closer_is_old = false;
  s.may_change = true;
  s.views.clear();
  s.rooms.clear();
  s.next_room = 0;
  s.map_at_loss.reset();
}

}  // namespace pf
