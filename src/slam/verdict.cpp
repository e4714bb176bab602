// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/verdict.hpp"

#include <cmath>
#include <cstdio>

#include "posefusion/core/symmetric.hpp"

namespace pf {
namespace {

// Alignment and prediction agree when their difference is within so many standard deviations
// (squared; 6 degrees of freedom, 1 in 50000 by chance), or small anyway.
constexpr double kMaxMahalanobis2 = 30.0;
constexpr double kAgreeing_m = 0.02, kAgreeing_rad = 0.015;
// A converged alignment may still be a step of this from its end.
constexpr double kUnfinished_m = 0.004, kUnfinished_rad = 0.004;
// A step from a measured prediction that the images may prove: no robot makes a longer one between
// two frames.
constexpr double kMaxOverruled_m = 0.08, kMaxOverruled_rad = 0.07;
// Part of the model's points that a frame may see through: things are moved, people were fused.
constexpr double kMaxSeenThrough = 0.25;
// Part of the frame in the map below which a free direction is not left to the prior.
constexpr double kLeastOverlap = 0.3;

std::string stepText(const Eigen::Isometry3d& step, const char* what) {
  char text[96];
  std::snprintf(text, sizeof text, "%.3f m and %.1f degrees %s", step.translation().norm(),
                angleOf(step) * kDegreesPerRadian, what);
  return text;
}

/// Covariance of how far an alignment comes to lie from the prior that is a part of it: prior minus
/// posterior where the prior kept its weight. (Both added would count the prior's word twice.)
Matrix6d covarianceOfDifference(const PosePrior& prior, const TrackingResult& r) {
  const Matrix6d& P = prior.covariance;
  const Matrix6d& C = r.covariance;
  const Matrix6d of_prior = r.prior_weight * solve(P, C).transpose();
  const Matrix6d of_images = Matrix6d::Identity() - of_prior;
  const Matrix6d sum = of_images * C + propagated(of_images, P);
  return 0.5 * (sum + sum.transpose()) + independentCovariance(kUnfinished_m, kUnfinished_rad);
}

}  // namespace

std::string percentOf(double part, double whole, const char* what) {
  char text[80];
  std::snprintf(text, sizeof text, "%.0f %% %s", whole > 0 ? 100.0 * part / whole : 0.0, what);
  return text;
}

bool agree(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return isWithin(a.inverse() * b, kAgreeing_m, kAgreeing_rad);
}

Verdict judge(const WorkingFrame& frame, const TrackingResult& r, const PosePrior& prior,
              const TrackingConfig& config) {
  const double pixels = static_cast<double>(frame.depth_m.total());
  if (r.candidates < config.min_valid_fraction * pixels) {
    return {FrameOutcome::few_inliers,
            percentOf(r.candidates, pixels, "of the pixels have a model")};
  }
  if (!r.converged) return {FrameOutcome::not_converged, ""};
  if (r.inliers < config.min_inlier_fraction * r.candidates) {
    return {FrameOutcome::few_inliers, percentOf(r.inliers, r.candidates, "of the model agree")};
  }
  if (r.seen_through > kMaxSeenThrough * r.candidates) {
    return {FrameOutcome::seen_through, percentOf(r.seen_through, r.candidates, "of the model")};
  }
  if (r.free_directions > 0 && !prior.is_measured) return {FrameOutcome::degenerate, ""};
  if (r.free_directions > 0 && r.candidates < kLeastOverlap * frame.valid_pixels) {
    return {FrameOutcome::degenerate,
            percentOf(r.candidates, frame.valid_pixels, "of the frame in the map")};
  }
  const Eigen::Isometry3d difference = prior.T_map_camera.inverse() * r.T_map_camera;
  if (agree(prior.T_map_camera, r.T_map_camera)) return {};
  const std::string text = stepText(difference, "from the prediction");
  const Vector6d error = logSe3(difference);
  const Matrix6d covariance = covarianceOfDifference(prior, r);
  const bool is_expected = mahalanobis2(error, covariance) < kMaxMahalanobis2;
  // Anything may have happened where nothing was measured: the images alone have to prove it.
  if (is_expected) {
    return {FrameOutcome::fused, text, prior.is_measured ? Proof::none : Proof::likely};
  }
  if (!prior.is_measured) return {FrameOutcome::jumped, text};
  if (!isWithin(difference, kMaxOverruled_m, kMaxOverruled_rad)) {
    return {FrameOutcome::disagrees, text};
  }
  // Where both are sure, alignment is right: it has a thousand times the pixels, and corners may
  // follow an unmasked person.
  return {FrameOutcome::fused, text, Proof::sure};
}

}  // namespace pf
