// SPDX-License-Identifier: BSD-3-Clause
// How a lost camera comes back.
#include <algorithm>
#include <cstdio>
#include <utility>

#include "posefusion/loop/verify.hpp"
#include "posefusion/slam/localiser.hpp"

namespace pf {
namespace {

// Of the frame before the first: no flow begins there, and trusted_ns_ is another one.
constexpr std::int64_t kNoFrame = -1;
// After a loss an alignment has to look better than usual, in so many frames in a row, before it is
// believed.
constexpr double kProof_s = 1.0 / 3.0;
constexpr double kProofOfPlace_s = 0.1;  // where the place was already verified
constexpr int kFewestProofs = 2;         // one frame fits none before it
constexpr double kSuggested_m = 0.05, kSuggested_rad = 0.05;
constexpr double kProofStep_m = 0.03, kProofStep_rad = 0.03;

// After a gap so long, or so far from where it was seen last, the camera may be where a fall threw
// it, and one frame is little to go by.
constexpr double kMaxBlind_s = 0.25, kMaxBlind_m = 0.15;
// A turn blurs frames too, but does not take the camera so far until one is looked at (0.2 s). In
// a fall a blurred frame fits the map at more places than its own, and its corners are not good.
constexpr double kMaxForcedWay_m = 0.12;

// Where people leave no more of the picture than this, the pose must be as accurate as at a
// searched place: often only corners remain, and some lie on people that were missed.
constexpr double kLittleView = 0.4;

int proofsIn(double seconds, const Pace& pace) {
  return std::max(kFewestProofs, pace.framesIn(seconds));
}

/// Describes how badly a pose from little of the picture is known; empty: well enough.
std::string poorlyKnown(const WorkingFrame& frame, const TrackingResult& tracking) {
  if (frame.valid_pixels >= kLittleView * static_cast<double>(frame.depth_m.total())) return {};
  const double sigma_m = positionSigma(tracking.covariance);
  if (sigma_m <= VerifyLimits().max_sigma_m) return {};
  char text[48];
  std::snprintf(text, sizeof text, "little in view, known to %.3f m", sigma_m);
  return text;
}

/// The pose of an alignment, asked as strictly as a place that was searched.
PlaceVerdict askStrictly(const WorkingFrame& frame, const TrackingResult& tracking,
                         const ViewRenderer& render) {
  PlaceVerdict verdict;
  verdict.alignment = tracking;
  verdict.agreement = compareViews(frame, render(tracking.T_map_camera));
  verdict.doubt = judgePlace(verdict, tracking.T_map_camera, {});
  return verdict;
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
    if (state_ == TrackingState::lost || (!is_blind && !is_far)) return {};
    return {FrameOutcome::disagrees, "blurred, and far from the last pose"};
  }
  const bool is_after_gap =
      state_ == TrackingState::doubtful && (blind_s > kMaxBlind_s || way.norm() > kMaxBlind_m);
  const bool is_alone = !prior.is_measured && !agree(prior.T_map_camera, tracking.T_map_camera);
  if (!is_after_gap && !is_alone) return {};
  const PlaceVerdict strict = askStrictly(frame, tracking, render);
  const bool by_shape =
      !is_after_gap && strict.doubt == PlaceDoubt::other_picture && hasShape(strict.agreement);
  if (strict.accepted() || by_shape) return {};
  char why[64] = "no corner measures the motion";
  if (is_after_gap) std::snprintf(why, sizeof why, "after %.1f s without a pose", blind_s);
  return {FrameOutcome::disagrees,
          std::string(why) + ", the map from there: " + std::string(name(strict.doubt))};
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

/// Lost: an alignment is believed once it has looked right for several frames that also fit each
/// other. Where no search has verified the place, the last of them is: tracking is content with
/// less, and an alignment that slid along a wall or a floor looks right to it in every frame.
void Localiser::prove(const WorkingFrame& frame, const PosePrior& prior, Location& location,
                      const MapRenderers& render) {
  const int needed = proofsIn(kProof_s, pace_);
  // A blurred frame proves nothing, but what was proven goes on through it.
  const bool is_blurred = location.outcome == FrameOutcome::forced;
  const bool looks_right = (is_blurred || location.outcome == FrameOutcome::fused) &&
                           (is_place_verified_ || isProof(location.tracking, frame.valid_pixels));
  const bool follows = isWithin(prior.T_map_camera.inverse() * location.tracking.T_map_camera,
                                kProofStep_m, kProofStep_rad);
  // A suggested place is better known than where the camera went from it.
  const bool fits = follows || std::exchange(is_suggested_, false);
  proofs_ = looks_right ? (fits ? proofs_ : 0) + (is_blurred ? 0 : 1) : 0;
  is_place_verified_ = is_place_verified_ && looks_right && fits;
  // After a verified place the next view may hardly constrain the pose.
  const bool is_unsure = is_place_verified_ &&
                         positionSigma(location.tracking.covariance) > VerifyLimits().max_sigma_m;
  if (is_unsure) proofs_ = std::min(proofs_, needed - 1);
  if (proofs_ >= needed) {
    const PlaceDoubt doubt = is_place_verified_
                                 ? PlaceDoubt::none
                                 : askStrictly(frame, location.tracking, render.view).doubt;
    location.is_return = doubt == PlaceDoubt::none;
    if (location.is_return) {
      frames_since_return_ = 0;
      return;
    }
    proofs_ = 0;
    location.outcome = FrameOutcome::disagrees;
    location.detail = "after " + std::to_string(needed) +
                      " frames, the map from there: " + std::string(name(doubt));
  }
  // Good enough to track on is not good enough to come back: only `trust` lets a frame be fused.
  if (location.outcome == FrameOutcome::fused) {
    location.outcome = FrameOutcome::unproven;
    location.detail = std::to_string(proofs_) + " of " + std::to_string(needed) + " frames";
  }
  previous_.T_map_camera = looks_right ? location.tracking.T_map_camera : prior.T_map_camera;
  previous_.covariance = looks_right ? location.tracking.covariance : prior.covariance;
  previous_.velocity.setZero();
  location.state = TrackingState::lost;
  location.fragment = located_.fragment;
  location.T_map_camera = located_.T_map_camera;
}

void Localiser::suggest(const MapPose& pose, const Eigen::Isometry3d& T_reckoned) {
  // What only looks right gives way to a place that was verified.
  if (state_ != TrackingState::lost || is_place_verified_) return;
  const Eigen::Isometry3d T_map_now = pose.T_map_camera * T_reckoned.inverse() * T_reckoned_;
  landmarks_.move(T_map_now * previous_.T_map_camera.inverse());
  previous_.fragment = pose.fragment;
  previous_.T_map_camera = T_map_now;
  previous_.covariance = independentCovariance(kSuggested_m, kSuggested_rad);
  previous_.velocity.setZero();
  proofs_ = proofsIn(kProof_s, pace_) - proofsIn(kProofOfPlace_s, pace_);
  is_suggested_ = is_place_verified_ = true;
}

/// Gives up a place suggested in another fragment than that of the last pose.
void Localiser::goBackToLast() {
  landmarks_.move(located_.T_map_camera * previous_.T_map_camera.inverse());
  previous_.fragment = located_.fragment;
  previous_.T_map_camera = located_.T_map_camera;
  proofs_ = 0;
  is_suggested_ = is_place_verified_ = false;
}

}  // namespace pf
