// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>

#include "mapper_state.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/map/deform.hpp"
#include "posefusion/map/layers.hpp"

namespace pf {
namespace {

// A camera anywhere in a loaded map is looked for around keyframes so far from each other: a search
// reaches 0.9 m each way. So many of them at once, in turns, that an answer comes soon.
constexpr double kRoomSide_m = 1.0;
constexpr std::size_t kRoomsAtOnce = 4;

double largestShiftM(const std::vector<Eigen::Isometry3d>& before,
                     const std::vector<Eigen::Isometry3d>& after) {
  double largest = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    largest = std::max(largest, (after[i].translation() - before[i].translation()).norm());
  }
  return largest;
}

}  // namespace

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

/// The camera was located. In a fragment the search for the fragment's place goes on.
void Mapper::State::endSearch() {
  if (fragment != 0) return;
  map_at_loss.reset();
  rooms.clear();
}

/// Hands a fused frame to the graph; a new keyframe is a question to the loop closer.
void Mapper::State::keep(const StaticFrame& input, const Location& location) {
  endSearch();
  FusedFrame fused;
  fused.stamp_ns = last_stamp_ns;
  fused.map_frame = map.frame();
  fused.T_map_camera = location.T_map_camera;
  fused.covariance = location.tracking.covariance;
  fused.is_return = location.is_return;
  fused.carried = location.carried;
  fused.begins_fragment = fragment != 0 && fragment != back_end.graph().keyframes().back().fragment;
  const int id = back_end.add(fused);
  if (id < 0) return;
  if (config.loop.enabled) {
    tellCloser();
    if (!question->corrected.empty()) question->corrected.pop_back();  // it is new itself
  }
  const bool nobody = input.mask.empty() || cv::countNonZero(input.mask) == 0;
  views.push_back(keyframeView(frame, id, location.T_map_camera, nobody));
  if (config.loop.enabled) question->keyframe = views.back();
}

/// Begins a question, or goes on with it, by what the closer does not know yet.
void Mapper::State::tellCloser() {
  if (!question) question.emplace();
  question->stamp_ns = last_stamp_ns;
  if (std::exchange(closer_is_old, false)) {
    question->known.emplace(views.begin(), views.end());
    keyframes_moved = true;
  }
  if (std::exchange(keyframes_moved, false)) question->corrected = back_end.keyframePoses();
}

/// Lost: asks where this frame is, unless the answer for one before is still to come.
void Mapper::State::askForPlace() {
  const double pixels = static_cast<double>(frame.depth_m.total());
  if (!config.loop.enabled || place_is_asked ||
      frame.valid_pixels < config.tracking.min_view_fraction * pixels) {
    return;
  }
  if (!map_at_loss) map_at_loss = searchedMap();
  tellCloser();
  PlaceQuestion place{frame.clone(), map_at_loss, localiser.lastPose()};
  for (std::size_t i = 0; i < std::min(kRoomsAtOnce, rooms.size()); ++i) {
    place.elsewhere.push_back(rooms[next_room++ % rooms.size()]);
  }
  question->place = std::make_shared<const PlaceQuestion>(std::move(place));
  T_reckoned_at_question = localiser.reckonedPose();
  at_question = {};
  place_is_asked = true;
  place_is_stale = false;
}

void Mapper::State::correct(const std::vector<LoopConstraint>& loops) {
  const std::vector<Eigen::Isometry3d> before = back_end.keyframePoses();
  Eigen::Isometry3d T_new_old = Eigen::Isometry3d::Identity();
  bool moves = false;
  for (const Deformation& deformation : back_end.close(loops)) {
    if (deformation.isIdentity()) continue;
    moves = true;
    T_new_old = deformation.at(map.frame()) * T_new_old;
    deform(map, deformation);
  }
  if (!moves) return;
  // What moves no keyframe so far lays no pass over another.
  if (largestShiftM(before, back_end.keyframePoses()) > kLeastLayer_m) removeYoungerLayers(map);
  localiser.move(T_new_old);
  const bool is_fused = view.stamp_ns == last_stamp_ns;
  showFrom(T_new_old * view.T_map_camera, is_fused);
  keyframes_moved = true;
  map_at_loss.reset();
  seen_at.reset();
  place_is_stale = true;
  fragment = fragmentAt(localiser.lastPose());
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
      if (s.at_question.keyframe >= 0 && s.may_change) s.placeFragment(answer.place->alignment);
    }
  }
  if (!answer.loops.empty() && s.may_change) s.correct(answer.loops);
}

void Mapper::introduceCloser() {
  state_->closer_is_old = !state_->views.empty();
  state_->place_is_asked = false;  // of somebody who does not answer any more
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
  s.T_world_map = saved.T_world_map;
  s.back_end = BackEnd(std::move(graph), std::move(saved.frames));
  s.camera = saved.camera;
  s.frame.camera = saved.camera.shrunk(s.config.frame.shrink);
  for (KeyframeView& view : saved.views) {
    if (view.intensity.size() != cv::Size(s.frame.camera.width, s.frame.camera.height)) continue;
    view.camera = s.frame.camera;
    s.views.push_back(std::move(view));
  }
  s.may_change = use == MapUse::extend;
  s.closer_is_old = true;
  const std::vector<Eigen::Isometry3d> poses = s.back_end.keyframePoses();
  for (const Eigen::Isometry3d& pose : poses) {
    s.last_fragment = std::max(s.last_fragment, fragmentAt(pose));
  }
  s.seek(poses.back(), saved.brightness);
}

void Mapper::restartClock() {
  State& s = *state_;
  if (s.back_end.graph().keyframes().empty()) return reset();
  s.last_stamp_ns = kBeforeAll;
  s.lost_s.reset();
  s.seek(s.localiser.lastPose(), s.localiser.brightness());
}

/// The camera is lost, and looked for everywhere in the map.
void Mapper::State::seek(const Eigen::Isometry3d& T_map_last, Brightness brightness) {
  rooms = spreadOut(back_end.keyframePoses());
  map_at_loss.reset();
  place_is_stale = true;  // by what was asked before
  localiser.beginLost(T_map_last, brightness);
  showFrom(T_map_last, false);
}

SavedMap Mapper::saved(const PinholeCamera& camera) const {
  const State& s = *state_;
  const PoseGraph& graph = s.back_end.graph();
  SavedMap saved;
  saved.camera = camera;
  saved.brightness = s.localiser.brightness();
  saved.surfels = s.map.collect();
  saved.frame = s.map.frame();
  saved.T_world_map = s.T_world_map;
  saved.keyframes = graph.keyframes();
  saved.constraints = graph.constraints();
  saved.graph_version = graph.version();
  saved.frames = s.back_end.frames();
  saved.views = s.views;
  return saved;
}

}  // namespace pf
