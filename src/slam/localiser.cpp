// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/localiser.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "posefusion/calibration/depth_correction.hpp"
#include "posefusion/core/same_pose.hpp"
#include "posefusion/tracking/view_motion.hpp"

namespace pf {
namespace {

constexpr double kNanosecond = 1e-9;
// Dead reckoning: for how long, and at what speed, corners alone give a pose good enough to report.
constexpr double kMaxReckoning_s = 0.6;
constexpr int kManyCorners = 80;
constexpr double kMostCorners = 0.8;  // part of them that agree
constexpr double kMaxReckoned_m_s = 1.2, kMaxReckoned_rad_s = 1.8;
constexpr double kProbation_s = 2.0;

}  // namespace

Localiser::Localiser(const TrackingConfig& config) : config_(config) {}

Location Localiser::begin(const WorkingFrame& frame, std::int64_t stamp_ns, const MapPose& pose,
                          const Brightness& brightness) {
  reset();
  pace_ = frame.pace;
  previous_.fragment = pose.fragment;
  Location location;
  location.T_map_camera = location.tracking.T_map_camera = pose.T_map_camera;
  location.tracking.brightness = brightness;
  location.tracking.converged = true;
  trust(location, stamp_ns, 0.0);
  remember(frame, {}, {pose.T_map_camera}, location, stamp_ns);
  return location;
}

Location Localiser::locate(const WorkingFrame& frame, std::int64_t stamp_ns, const SparseFlow& flow,
                           bool forced, const ModelView& view, const MapRenderers& render,
                           const std::optional<MotionPrior>& told) {
  Location location;
  pace_ = frame.pace;
  const double elapsed_s = kNanosecond * static_cast<double>(stamp_ns - previous_.stamp_ns);
  const PosePrior prior =
      expect(frame, stamp_ns, flow, viewBefore(flow, view, render.view), told, location);
  const bool was_lost = state_ == TrackingState::lost;
  const Attempt aligned =
      align(frame, forced, was_lost ? startAt(prior.T_map_camera) : prior, render);
  location.tracking = aligned.result;
  Verdict verdict = aligned.verdict;
  if (verdict.outcome == FrameOutcome::fused && !was_lost) {
    verdict = askFurther(frame, location, prior, {stamp_ns, forced}, render.view);
  }
  if (forced && verdict.outcome == FrameOutcome::fused) {
    verdict = {FrameOutcome::forced, "too blurred to be fused"};
  }
  location.outcome = verdict.outcome;
  location.detail = verdict.detail;
  if (was_lost) {
    prove(frame, prior, location, render.view);
    if (location.is_return) trust(location, stamp_ns, elapsed_s);
  } else if (verdict.outcome == FrameOutcome::fused) {
    trust(location, stamp_ns, elapsed_s);
  } else {
    distrust(location, prior, stamp_ns);
  }
  location.covariance = recent_.apart(location.tracking, frame.camera);
  previous_.covariance_to_view =
      state_ == TrackingState::tracking ? location.covariance : previous_.covariance;
  remember(frame, flow, prior, location, stamp_ns);
  return location;
}

/// Whether the images have to speak for an alignment. A blurred picture proves nothing, and is not
/// fused; while lost `prove` asks for proof.
bool Localiser::mustBeProven(const Attempt& attempt, bool forced) const {
  return attempt.isBelieved() && !forced && attempt.verdict.proof != Proof::none &&
         state_ != TrackingState::lost;
}

/// Whether they do as far as its verdict asks.
bool Localiser::isProven(const WorkingFrame& frame, const Attempt& attempt,
                         const MapRenderers& render) const {
  const double needed =
      attempt.verdict.proof == Proof::likely ? 0.0 : logOdds(config_.sure_to_return);
  const ModelView& view = render.view(attempt.result.T_map_camera);
  return poseEvidence(frame, attempt.result, view).log_odds >= needed;
}

Localiser::Attempt Localiser::alignFrom(const Eigen::Isometry3d& guess, bool firm,
                                        const WorkingFrame& frame, bool forced,
                                        const PosePrior& prior, const MapRenderers& render) const {
  const RenderedModel model = render.model(guess);
  const TrackingStart start{model.T_map_view, guess, prior, brightness_, firm, true};
  Attempt attempt{track(frame, model.points, start, config_), {}};
  attempt.verdict = judge(frame, attempt.result, prior, config_);
  if (mustBeProven(attempt, forced) && !isProven(frame, attempt, render)) {
    attempt.verdict.outcome = prior.is_measured ? FrameOutcome::disagrees : FrameOutcome::jumped;
  }
  return attempt;
}

/// What the images alone speak for may be one of several minima along a wall: corners of the drawn
/// map tell where a better one lies. Not while lost: of a wrong place the best minimum is as wrong,
/// and only looks more likely.
Localiser::Attempt Localiser::withoutSlip(const Attempt& found, const WorkingFrame& frame,
                                          const PosePrior& prior,
                                          const MapRenderers& render) const {
  const Eigen::Isometry3d& T_map_camera = found.result.T_map_camera;
  const SparseMotion left = motionFromView(frame, render.view(T_map_camera));
  if (!left.found || isWithin(left.T_before_after, kSamePose)) return found;
  const Attempt moved =
      alignFrom(T_map_camera * left.T_before_after, false, frame, false, prior, render);
  return moved.isBelieved() && moved.result.cost < found.result.cost ? moved : found;
}

/// Aligns from the prediction and, where the result is not believed, from other starts.
Localiser::Attempt Localiser::align(const WorkingFrame& frame, bool forced, const PosePrior& prior,
                                    const MapRenderers& render) const {
  Attempt best;
  best.result.T_map_camera = prior.T_map_camera;
  const double pixels = static_cast<double>(frame.depth_m.total());
  if (frame.valid_pixels < config_.min_view_fraction * pixels) {
    best.verdict = {FrameOutcome::no_depth,
                    percentOf(frame.valid_pixels, pixels, "of the pixels have depth")};
    return best;
  }
  const auto attempt = [&](const Eigen::Isometry3d& guess, bool firm) {
    Attempt found = alignFrom(guess, firm, frame, forced, prior, render);
    if (mustBeProven(found, forced)) found = withoutSlip(found, frame, prior, render);
    if (found.isBelieved() || best.result.candidates == 0) best = found;
    return found.isBelieved();
  };
  if (attempt(prior.T_map_camera, false)) return best;
  // The images may have slid along a wall: hold the motion where it is known.
  if (prior.is_measured && attempt(prior.T_map_camera, true)) return best;
  if (state_ == TrackingState::lost) return best;
  if (config_.rotation_prealignment) {
    const FrameLevel& coarse = frame.levels[kLevels - 1];
    Eigen::Isometry3d turned = previous_.T_map_camera;
    turned.linear() *=
        alignRotation(previous_.small, {coarse.intensity, coarse.still}, coarse.camera).transpose();
    if (attempt(turned, false)) return best;
  }
  attempt(previous_.T_map_camera, false);
  return best;
}

void Localiser::trust(Location& location, std::int64_t stamp_ns, double elapsed_s) {
  location.fragment = previous_.fragment;
  location.T_map_camera = location.tracking.T_map_camera;
  location.located = true;
  location.outcome = FrameOutcome::fused;
  location.is_recent_return = frames_since_return_ < pace_.framesIn(kProbation_s);
  location.state = state_ = TrackingState::tracking;
  if (elapsed_s > 0) {
    previous_.velocity =
        logSe3(previous_.T_map_camera.inverse() * location.T_map_camera) / elapsed_s;
    previous_.velocity_ns = location.motion.found ? stamp_ns : 0;
    previous_.velocity_covariance = location.motion.covariance / (elapsed_s * elapsed_s);
  }
  ++frames_since_return_;
  previous_.T_map_camera = location.T_map_camera;
  located_ = location.pose();
  previous_.covariance = location.tracking.covariance;
  brightness_ = location.tracking.brightness;
  carried_.T_map_camera = location.T_map_camera;
  carried_.covariance.setZero();
  carried_.is_measured = true;
  trusted_ns_ = seen_ns_ = stamp_ns;
  untrusted_in_a_row_ = reckoned_in_a_row_ = 0;
}

/// Whether the predicted pose alone is good enough to report: by many corners, for a short time; or
/// with the robot's odometry as long as it is known as well as at a searched place.
bool Localiser::isReckonedWell(const Location& location, const PosePrior& prior,
                               double reckoned_s) const {
  const SparseMotion& motion = location.motion;
  if (location.has_odometry && positionSigma(prior.covariance) <= kKnownSigma_m) return true;
  return motion.found && motion.inliers >= kManyCorners &&
         motion.inliers >= kMostCorners * motion.matches && reckoned_s < kMaxReckoning_s &&
         isWithin(motion.T_before_after, kMaxReckoned_m_s * pace_.frame_s,
                  kMaxReckoned_rad_s * pace_.frame_s);
}

/// The frame is not trusted: the prediction continues the pose, which is reported as long as it is
/// good.
void Localiser::distrust(Location& location, const PosePrior& prior, std::int64_t stamp_ns) {
  ++untrusted_in_a_row_;
  const double reckoned_s = kNanosecond * static_cast<double>(stamp_ns - seen_ns_);
  location.located =
      untrusted_in_a_row_ == reckoned_in_a_row_ + 1 && isReckonedWell(location, prior, reckoned_s);
  if (location.outcome == FrameOutcome::forced) {
    // Not reported where alignment needs the blurred frame's corners, or they contradict it: in a
    // turn they do not, in a fall they do.
    const Eigen::Isometry3d off = prior.T_map_camera.inverse() * location.tracking.T_map_camera;
    location.located =
        location.tracking.free_directions == 0 && (!prior.is_measured || isWithin(off, kSamePose));
    if (location.located) seen_ns_ = stamp_ns;
  } else {
    location.tracking.T_map_camera = prior.T_map_camera;
    location.tracking.covariance = prior.covariance;
    location.tracking.distance_m = 0;
  }
  previous_.T_map_camera = location.tracking.T_map_camera;
  previous_.covariance = location.tracking.covariance;
  if (location.located) {
    ++reckoned_in_a_row_;
    located_.T_map_camera = previous_.T_map_camera;
  }
  const bool lost =
      !location.located && untrusted_in_a_row_ >= pace_.framesIn(config_.lost_after_s);
  location.state = state_ = lost ? TrackingState::lost : TrackingState::doubtful;
  location.fragment = located_.fragment;
  location.T_map_camera = located_.T_map_camera;
  belief_ = 0;
  is_suggested_ = false;
}

void Localiser::move(const Eigen::Isometry3d& T_new_old, int fragment) {
  if (previous_.fragment != located_.fragment) goBackToLast();
  previous_.T_map_camera = T_new_old * previous_.T_map_camera;
  located_.T_map_camera = T_new_old * located_.T_map_camera;
  previous_.fragment = located_.fragment = fragment;
  carried_.T_map_camera = T_new_old * carried_.T_map_camera;
  landmarks_.move(T_new_old);
}

void Localiser::correctDepth(DepthCorrector& step) {
  previous_.depth_m = step.inMetres(previous_.depth_m, 1.0);
  landmarks_.clear();  // where they are seen now is not where they were
}

void Localiser::remember(const WorkingFrame& frame, const SparseFlow& flow, const PosePrior& prior,
                         const Location& location, std::int64_t stamp_ns) {
  // Overruled, or found elsewhere: the landmarks come along.
  if (!agree(prior.T_map_camera, previous_.T_map_camera)) {
    landmarks_.move(previous_.T_map_camera * prior.T_map_camera.inverse());
  }
  landmarks_.update(flow, {frame.full_depth_m, frame.full_camera, frame.sensor, frame.pace},
                    previous_.T_map_camera, location.outcome == FrameOutcome::fused);
  const FrameLevel& coarse = frame.levels[kLevels - 1];
  previous_.stamp_ns = stamp_ns;
  frame.full_depth_m.copyTo(previous_.depth_m);
  coarse.intensity.copyTo(previous_.small.intensity);
  coarse.still.copyTo(previous_.small.still);
}

}  // namespace pf
