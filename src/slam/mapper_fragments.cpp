// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "mapper_state.hpp"
#include "posefusion/core/same_pose.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/core/symmetric.hpp"

namespace pf {
namespace {

// A gap counts for no more than this: only frames show that the place is unknown.
constexpr double kMostElapsed_s = 0.5;
// Where people or a hand leave less of the view than this, the camera is covered: the place need
// not be unknown, and a fragment would be made of scraps.
constexpr double kOpenView = 0.25;
constexpr double kToPlace_s = 0.5;  // between two questions where the fragment lies

}  // namespace

bool Mapper::State::isViewOpen() const {
  return frame.valid_pixels >= kOpenView * static_cast<double>(frame.depth_m.total());
}

/// Where the last frame was tracked; nothing where it was not.
std::optional<MapPose> Mapper::State::trackedPose() const {
  if (localiser.state() != TrackingState::tracking) return std::nullopt;
  return localiser.lastPose();
}

/// `before`: trackedPose() before the frame.
void Mapper::State::reckon(const Location& location, const std::optional<MapPose>& before,
                           std::int64_t before_ns) {
  const double elapsed_s = before_ns == kBeforeAll ? 0 : secondsBetween(before_ns, last_stamp_ns);
  if (location.located && isPlaceKnown()) {
    reckoning.know(location.T_map_camera, location.tracking.covariance);
  } else if (location.located && before && before->fragment == location.fragment) {
    reckoning.move(before->T_map_camera.inverse() * location.T_map_camera, location.covariance,
                   elapsed_s);
  } else if (location.step && location.step->has_shift) {
    reckoning.move(location.step->T_before_after, location.step->covariance, elapsed_s);
  } else {
    reckoning.pass(elapsed_s);
  }
}

/// `before_ns`: stamp of the frame before; kBeforeAll: there was none.
void Mapper::State::countLostTime(const Location& location, std::int64_t before_ns) {
  if (location.state != TrackingState::lost) return lost_s.reset();
  if (!lost_s) {
    lost_s = 0.0;
    if (!isPlaceKnown()) map_at_loss.reset();  // the fragment belongs into it
  }
  if (before_ns != kBeforeAll && isViewOpen()) {
    *lost_s += std::min(secondsBetween(before_ns, last_stamp_ns), kMostElapsed_s);
  }
}

/// Lost for long, and no place to come back to is being proven.
bool Mapper::State::wantsFragment(const StaticFrame& input) const {
  const double after_s = config.loop.new_fragment_after_s;
  return config.loop.enabled && after_s > 0 && lost_s >= after_s && may_change && !input.forced &&
         isViewOpen() && !localiser.isProving();
}

/// The frame begins a piece of the map of its own, at the origin of its own coordinates.
Location Mapper::State::beginFragment() {
  if (!map_at_loss) map_at_loss = searchedMap();
  rooms = spreadOut(back_end.keyframePoses());
  ++last_fragment;
  lost_s.reset();
  seen_at.reset();
  place_is_stale = true;  // what was asked was asked of a lost camera
  MapPose pose{last_fragment, localiser.reckonedPose()};
  pose.T_map_camera.translation().setZero();
  const Brightness brightness = localiser.brightness();
  Location location = localiser.begin(frame, last_stamp_ns, pose, brightness);
  location.detail = "begins fragment " + std::to_string(last_fragment);
  return location;
}

/// A copy of the map to look for the camera in: where it is tracked in a fragment, the rest of the
/// map, for in the fragment it would find itself.
std::shared_ptr<const SurfelMap> Mapper::State::searchedMap() const {
  auto searched = std::make_shared<SurfelMap>(map);
  if (!isPlaceKnown() && localiser.state() != TrackingState::lost) {
    searched->removeFragments([this](int of_block) { return of_block == fragment(); });
  }
  return searched;
}

/// Asks now and then where in the rest of the map the fragment lies.
void Mapper::State::askForFragment() {
  if (isPlaceKnown() || --frames_to_place > 0 || place_is_asked) return;
  frames_to_place = frame.pace.framesIn(kToPlace_s);
  askForPlace();
  if (!place_is_asked) return;
  const Keyframe& last = back_end.graph().keyframes().back();
  at_question = {last.id, last.T_map_camera.inverse() * localiser.lastPose().T_map_camera};
}

/// The frame that was asked about lies there: the fragment is joined when that is said twice.
void Mapper::State::placeFragment(const PlaceVerdict& seen) {
  const auto& keyframes = back_end.graph().keyframes();
  const Keyframe& keyframe = keyframes[static_cast<std::size_t>(at_question.keyframe)];
  const int near = back_end.nearest(seen.pose());
  if (keyframe.fragment != fragment() || seen.fragment == fragment() || near < 0) return;
  const Eigen::Isometry3d& T_camera = at_question.T_keyframe_camera;
  const Eigen::Isometry3d T_other_keyframe = seen.alignment.T_map_camera * T_camera.inverse();
  const Matrix6d A = adjoint(T_camera);
  FragmentPlace place;
  place.other = seen.fragment;
  place.T_other_fragment = T_other_keyframe * keyframe.T_map_camera.inverse();
  place.constraint.from = near;
  place.constraint.to = keyframe.id;
  place.constraint.T_from_to =
      keyframes[static_cast<std::size_t>(near)].T_map_camera.inverse() * T_other_keyframe;
  place.constraint.covariance = propagated(A, seen.alignment.covariance);
  // Two answers in a row that place the fragment alike are believed.
  const bool again =
      seen_at && seen_at->other == place.other &&
      isWithin(T_other_keyframe.inverse() * seen_at->T_other_fragment * keyframe.T_map_camera,
               kSamePose);
  seen_at = place;
  frames_to_place = 0;  // the second answer soon
  if (again) wanted.loops.push_back(place.constraint.asPoseConstraint());
}

}  // namespace pf
