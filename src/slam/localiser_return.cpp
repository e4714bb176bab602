// SPDX-License-Identifier: BSD-3-Clause
// How a lost camera comes back.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "posefusion/core/same_pose.hpp"
#include "posefusion/core/symmetric.hpp"
#include "posefusion/slam/localiser.hpp"
#include "posefusion/tracking/pose_evidence.hpp"

namespace pf {
namespace {

// Of the frame before the first: no flow begins there, and trusted_ns_ is another one.
constexpr std::int64_t kNoFrame = -1;
// Frames of so long see nearly the same: together they say little more than one.
constexpr double kSameView_s = 0.5;
// No frame speaks louder than this for a place, whatever the model says.
constexpr double kMostSure = 0.9999;
// A place that a search has found is confirmed by frames of so long.
constexpr double kConfirmed_s = 0.1;

// After a gap so long, or so far from where it was seen last, the camera may be where a fall threw
// it, and one frame is little to go by.
constexpr double kMaxBlind_s = 0.25, kMaxBlind_m = 0.15;
// A turn blurs frames too, but does not take the camera so far until one is looked at (0.2 s). In
// a fall a blurred frame fits the map at more places than its own, and its corners are not good.
constexpr double kMaxForcedWay_m = 0.12;

// Where people leave no more of the picture than this, the pose must be as accurate as at a
// searched place: often only corners remain, and some lie on people that were missed.
constexpr double kLittleView = 0.4;

/// How much of what frames of so long say is new.
double shareOfNews(double seconds) { return 1.0 - std::exp(-seconds / kSameView_s); }

/// Describes how badly a pose from little of the picture is known; empty: well enough.
std::string poorlyKnown(const WorkingFrame& frame, const TrackingResult& tracking) {
  if (frame.valid_pixels >= kLittleView * static_cast<double>(frame.depth_m.total())) return {};
  const double sigma_m = positionSigma(tracking.covariance);
  if (sigma_m <= kKnownSigma_m) return {};
  char text[48];
  std::snprintf(text, sizeof text, "little in view, known to %.3f m", sigma_m);
  return text;
}

std::string describe(const PoseEvidence& evidence) {
  char text[64];
  std::snprintf(text, sizeof text, "evidence %.1f, least by %s", evidence.log_odds,
                std::string(name(evidence.weakest)).c_str());
  return text;
}

}  // namespace

Verdict Localiser::askFurther(const WorkingFrame& frame, const Location& location,
                              const PosePrior& prior, const Moment& moment,
                              const ViewRenderer& render) const {
  const TrackingResult& tracking = location.tracking;
  const std::string poorly = poorlyKnown(frame, tracking);
  if (!poorly.empty()) return {FrameOutcome::degenerate, poorly};
  const double blind_s = 1e-9 * static_cast<double>(moment.stamp_ns - seen_ns_);
  const Eigen::Vector3d way =
      tracking.T_map_camera.translation() - located_.T_map_camera.translation();
  if (moment.forced) {
    const bool is_blind = !prior.is_measured && blind_s > kMaxBlind_s;
    const bool is_far = way.norm() > kMaxForcedWay_m;
    if (!is_blind && !is_far) return {};
    return {FrameOutcome::disagrees, "blurred, and far from the last pose"};
  }
  const bool is_after_gap =
      state_ == TrackingState::doubtful && (blind_s > kMaxBlind_s || way.norm() > kMaxBlind_m);
  if (!is_after_gap) return {};
  const PoseEvidence evidence = poseEvidence(frame, tracking, render(tracking.T_map_camera));
  if (isKnown(tracking) && evidence.log_odds >= logOdds(config_.sure_to_return)) return {};
  char why[48];
  std::snprintf(why, sizeof why, "after %.1f s without a pose: ", blind_s);
  return {FrameOutcome::disagrees, why + describe(evidence)};
}

void Localiser::beginLost(const MapPose& pose, const Brightness& brightness) {
  reset();
  state_ = TrackingState::lost;
  located_ = pose;
  previous_.fragment = pose.fragment;
  previous_.T_map_camera = pose.T_map_camera;
  previous_.stamp_ns = kNoFrame;
  brightness_ = brightness;
}

/// What the frame says for or against the pose that is carried along (Wald's sequential test, with
/// the news in each frame discounted: what is seen again is hardly news, what contradicts is).
void Localiser::gatherEvidence(const WorkingFrame& frame, const PosePrior& prior,
                               const Location& location, const ViewRenderer& render) {
  if (location.outcome == FrameOutcome::forced) return;  // a blurred frame says nothing
  if (location.outcome != FrameOutcome::fused) {
    belief_ = 0;
    return;
  }
  const bool follows =
      isWithin(prior.T_map_camera.inverse() * location.tracking.T_map_camera, kSamePose);
  // A place just found is better known than where the camera went from it.
  if (!std::exchange(is_suggested_, false) && !follows) belief_ = 0;
  const TrackingResult& tracking = location.tracking;
  const PoseEvidence evidence = poseEvidence(frame, tracking, render(tracking.T_map_camera));
  const double says = std::min(logOdds(kMostSure), evidence.log_odds);
  belief_ = std::max(0.0, belief_ + (says > 0 ? shareOfNews(frame.pace.frame_s) : 1.0) * says);
}

/// While lost: relocalises once the evidence gathered over frames is as much as `sure_to_return`
/// asks.
void Localiser::prove(const WorkingFrame& frame, const PosePrior& prior, Location& location,
                      const ViewRenderer& render) {
  gatherEvidence(frame, prior, location, render);
  const double needed = logOdds(config_.sure_to_return);
  // The next view may hardly constrain the pose.
  if (belief_ >= needed && isKnown(location.tracking) && location.outcome == FrameOutcome::fused) {
    location.is_return = true;
    frames_since_return_ = 0;
    return;
  }
  // Good enough to track on is not good enough to come back: only `trust` lets a frame be fused.
  if (location.outcome == FrameOutcome::fused) {
    location.outcome = FrameOutcome::unproven;
    char text[48];
    std::snprintf(text, sizeof text, "evidence %.1f of %.1f", belief_, needed);
    location.detail = text;
  }
  const bool is_carried_on = belief_ > 0;
  previous_.T_map_camera = is_carried_on ? location.tracking.T_map_camera : prior.T_map_camera;
  previous_.covariance = is_carried_on ? location.tracking.covariance : prior.covariance;
  previous_.forgetVelocity();
  location.state = TrackingState::lost;
  location.fragment = located_.fragment;
  location.T_map_camera = located_.T_map_camera;
}

void Localiser::suggest(const PlaceVerdict& place, const Eigen::Isometry3d& T_reckoned) {
  if (state_ != TrackingState::lost || belief_ >= place.log_odds) return;
  const Eigen::Isometry3d T_then_now = T_reckoned.inverse() * T_reckoned_;
  const Eigen::Isometry3d T_map_now = place.alignment.T_map_camera * T_then_now;
  const bool is_known_already = previous_.fragment == place.fragment &&
                                isWithin(previous_.T_map_camera.inverse() * T_map_now, kSamePose);
  const double confirmed =
      logOdds(config_.sure_to_return) - shareOfNews(kConfirmed_s) * logOdds(kMostSure);
  if (is_known_already && belief_ >= confirmed) return;  // later frames have said so too
  landmarks_.move(T_map_now * previous_.T_map_camera.inverse());
  previous_.fragment = place.fragment;
  previous_.T_map_camera = T_map_now;
  // As well as the place was known then; the way since is as good as alignments agree.
  previous_.covariance = propagated(adjoint(T_then_now.inverse()), place.alignment.covariance) +
                         covarianceOf(kSamePose);
  previous_.forgetVelocity();
  belief_ = confirmed;
  is_suggested_ = true;
}

/// Gives up a place suggested in another fragment than that of the last pose.
void Localiser::goBackToLast() {
  landmarks_.move(located_.T_map_camera * previous_.T_map_camera.inverse());
  previous_.fragment = located_.fragment;
  previous_.T_map_camera = located_.T_map_camera;
  belief_ = 0;
  is_suggested_ = false;
}

}  // namespace pf
