// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mapper_state.hpp"
#include "posefusion/core/error.hpp"

namespace pf {
namespace {

// A camera anywhere in a loaded map is looked for around so many poses at once, in turns, that an
// answer comes soon.
constexpr std::size_t kRoomsAtOnce = 4;
// Half of that reach, as the reckoned place is off itself; and twice of it, beyond which a search
// hardly helps.
constexpr double kCovered_m = 0.45, kMostUnsure_m = 1.8;

/// Which way a camera looks, about z.
double headingOf(const Eigen::Isometry3d& T_world_camera) {
  const Eigen::Vector3d ahead = T_world_camera.linear().col(2);
  return std::atan2(ahead.y(), ahead.x());
}

/// The keyframe of the first fragment that is nearest as seen from above.
std::optional<Eigen::Isometry3d> nearestBelow(const Eigen::Isometry3d& T_world_camera,
                                              const Eigen::Isometry3d& T_world_map,
                                              const std::vector<Keyframe>& keyframes) {
  std::optional<Eigen::Isometry3d> nearest;
  double least = std::numeric_limits<double>::max();
  for (const Keyframe& keyframe : keyframes) {
    if (keyframe.fragment != kFirstFragment) continue;
    const Eigen::Isometry3d T = T_world_map * keyframe.T_map_camera;
    const double far = (T.translation() - T_world_camera.translation()).head<2>().squaredNorm();
    if (far >= least) continue;
    least = far;
    nearest = T;
  }
  return nearest;
}

}  // namespace

/// The camera was located. In a fragment the search for the fragment's place goes on.
void Mapper::State::endSearch() {
  if (!isPlaceKnown()) return;
  map_at_loss.reset();
  rooms.clear();
  hint.reset();
}

/// Hands a fused frame to the graph; a new keyframe is a question to the loop closer.
void Mapper::State::keep(const StaticFrame& input, const Location& location) {
  endSearch();
  FusedFrame fused;
  fused.stamp_ns = last_stamp_ns;
  fused.map_frame = map.frame();
  fused.pose = location.pose();
  fused.covariance = location.tracking.covariance;
  fused.is_return = location.is_return;
  fused.carried = location.carried;
  if (!isPlaceKnown()) fused.reckoned = reckoning.pose();
  const int id = back_end.add(fused);
  if (id < 0) return;
  if (config.loop.enabled) {
    tellCloser();
    if (!question->corrected.empty()) question->corrected.pop_back();  // it is new itself
  }
  const bool no_people = input.mask.empty() || cv::countNonZero(input.mask) == 0;
  views.push_back(keyframeView(frame, id, location.pose(), no_people));
  if (!config.loop.enabled) return;
  question->keyframe = views.back();
  // As long as depth is off by a field that is not known well, two pictures measure a turn worse
  // than the map, which is the mean of many.
  if (is_calibration_loaded) question->step = back_end.stepTo(id);
}

/// Begins a question, or goes on with it, by what the closer does not know yet.
void Mapper::State::tellCloser() {
  if (!question) question.emplace();
  question->stamp_ns = last_stamp_ns;
  if (!retired.empty()) question->retired = std::exchange(retired, {});
  if (std::exchange(closer_is_old, false)) {
    question->known.emplace(views.begin(), views.end());
    keyframes_moved = true;
  }
  if (std::exchange(keyframes_moved, false)) question->corrected = back_end.keyframePoses();
  question->depth_version = depth_version;
  question->calibration = calibration;
  question->calibrates = std::exchange(calibration_is_asked, false);
  if (std::exchange(constraints_are_old, false)) {
    question->remeasured = back_end.graph().constraints();
  }
}

/// Where the camera may be by dead reckoning, if that is beyond what is searched around the last
/// pose, and near enough to the truth to be searched around.
std::optional<MapPose> Mapper::State::reckonedPlace() const {
  const auto reckoned = reckoning.pose();
  if (!reckoned) return std::nullopt;
  const MapPose& last = localiser.lastPose();
  const Eigen::Vector3d way =
      reckoned->T_map_camera.translation() - last.T_map_camera.translation();
  const bool is_covered = last.fragment == kFirstFragment && way.norm() < kCovered_m;
  const double sigma_m = std::sqrt(reckoned->covariance.diagonal().head<3>().maxCoeff());
  if (is_covered || sigma_m > kMostUnsure_m) return std::nullopt;
  return MapPose{kFirstFragment, reckoned->T_map_camera};
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
  if (hint) place.elsewhere.push_back(*hint);
  if (const auto reckoned = reckonedPlace()) place.elsewhere.push_back(*reckoned);
  if (const auto pose = reckoning.pose()) {
    const auto reckoned = back_end.reckonedFrom(*pose);
    if (reckoned) place.expected = std::make_shared<ExpectedPlace>(back_end.graph(), *reckoned);
  }
  const std::size_t most = place.elsewhere.size() + kRoomsAtOnce;
  for (std::size_t i = 0; i < rooms.size() && place.elsewhere.size() < most; ++i) {
    const MapPose& room = rooms[next_room++ % rooms.size()];
    if (place.admitsNear(room)) place.elsewhere.push_back(room);
  }
  question->place = std::make_shared<const PlaceQuestion>(std::move(place));
  T_reckoned_at_question = localiser.reckonedPose();
  at_question = {};
  place_is_asked = true;
  place_is_stale = false;
}

std::optional<LoopQuestion> Mapper::takeQuestion() {
  State& s = *state_;
  const bool waits = s.closer_is_old || s.constraints_are_old || s.calibration_is_asked;
  if (!s.question && waits && s.config.loop.enabled) s.tellCloser();
  return std::exchange(s.question, std::nullopt);
}

void Mapper::take(const LoopAnswer& answer) {
  State& s = *state_;
  if (answer.asked_for_place) {
    s.place_is_asked = false;
    if (answer.place && !s.place_is_stale) {
      s.localiser.suggest(*answer.place, s.T_reckoned_at_question);
      if (s.at_question.keyframe >= 0 && s.may_change) s.placeFragment(*answer.place);
    }
  }
  if (answer.step) s.retrack(*answer.step, answer.depth_version);
  if (!s.may_change) return;
  for (const LoopConstraint& loop : answer.loops) s.wanted.loops.push_back(loop.asPoseConstraint());
  s.take(answer);
}

bool Mapper::isLookedFor() const {
  return state_->state() == TrackingState::lost || !state_->isPlaceKnown();
}

std::string Mapper::hint(const Eigen::Isometry3d& T_world_camera) {
  State& s = *state_;
  if (!T_world_camera.matrix().allFinite()) {
    throw InputError("a pose that is not finite, expected numbers");
  }
  const Eigen::Isometry3d T_world_map = worldFromMap();
  const auto nearest = nearestBelow(T_world_camera, T_world_map, s.back_end.graph().keyframes());
  if (!nearest) throw InputError("there is no map yet that the camera could be looked for in");
  if (!isLookedFor()) return "the camera is not lost: nothing changes";
  const double turn_rad = headingOf(T_world_camera) - headingOf(*nearest);
  Eigen::Isometry3d T = *nearest;
  T.linear() = Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()) * nearest->linear();
  T.translation().head<2>() = T_world_camera.translation().head<2>();
  s.hint = MapPose{kFirstFragment, T_world_map.inverse() * T};
  return "the camera is looked for there too";
}

void Mapper::introduceCloser() {
  state_->closer_is_old = !state_->views.empty();
  state_->place_is_asked = false;  // of a closer that does not answer any more
}

void Mapper::restartClock() {
  State& s = *state_;
  if (s.back_end.graph().keyframes().empty()) return reset();
  s.last_stamp_ns = kBeforeAll;
  s.robot.restart();
  s.lost_s.reset();
  s.seek(s.localiser.lastPose(), s.localiser.brightness());
}

/// The camera is lost, and looked for everywhere in the map.
void Mapper::State::seek(const MapPose& last, Brightness brightness) {
  rooms = spreadOut(back_end.keyframePoses());
  reckoning.reset();
  map_at_loss.reset();
  place_is_stale = true;  // by what was asked before
  localiser.beginLost(last, brightness);
  showFrom(last, view.stamp_ns, false);
}

}  // namespace pf
