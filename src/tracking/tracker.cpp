// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/tracker.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "noise_information.hpp"
#include "place_errors.hpp"
#include "posefusion/core/symmetric.hpp"
#include "posefusion/tracking/normal_equations.hpp"

namespace pf {
namespace {

// A step below this (rad and m) ends a level; on the finest one it is also what "converged" means.
constexpr double kSmallStep = 1e-4;
constexpr double kConvergedStep = 4e-3;
constexpr int kMaxHalvings = 3;
// Pixels that come and go at the borders move the mean cost by about this.
constexpr double kCostNoise = 0.01;
// Residuals of so many standard deviations keep a quarter of their weight on the finest level.
constexpr float kRobustScale = 3.0F;
// Residuals of what is seen close together, and of one frame, go together (the sensor's distortion,
// the map's ripples): so large a part of what is seen (sr) says as much as one independent
// measurement, in however many pixels. 600 of them in a Kinect's picture at half its size.
constexpr double kHalfKinectFocal_px = 262.5;
constexpr double kMeasurement_sr = 600.0 / (kHalfKinectFocal_px * kHalfKinectFocal_px);
// Error of a normal (rad) per relative error of depth: a normal comes from some pixels'
// differences. Directions with less information than its square times that of the best-known one
// are fixed by noise alone. The same for pictures of any size: scaled by the angle of a pixel it
// found free directions at 1280 pixels across where there were none at 320 and 640.
constexpr double kNormalNoise = 14.0;
// Without a measured prior there is nothing better to decide: only what is plainly free counts as
// free.
constexpr double kBlindNormalNoise = 7.0;
constexpr double kMaxNormalNoise_rad = 0.12;
// A prior that the images contradict by so much (squared, in standard deviations of both) keeps a
// quarter of its weight: corners may follow an unmasked person.
constexpr double kPriorScale2 = 100.0;
constexpr double kMinLeverArm_m = 0.3;
// A prior follows from frames that saw the same places with the same errors: against those, one
// frame's prior says no more than this part of what it says against noise.
constexpr double kSameError_frames = 10.0;

struct Prior {
  Eigen::Isometry3d T_frame_view;
  Matrix6d information;
  bool is_firm;
  double normal_noise;  ///< see kNormalNoise
  DepthSensor sensor;
};

/// What the images say of the pose, with noise taken out.
struct ImageSystem {
  Matrix6d H, inverse;  ///< the inverse is zero in free directions
  Matrix6d kept;        ///< takes the noise out of a gradient
  Vector6d g;
  int free_directions = 0;
};

/// Leaves of the images' equations only what is more than noise; see kNormalNoise. `of_picture`:
/// what the picture's noise has added to H.
ImageSystem withoutNoise(const NormalEquations& e, double share, const Prior& prior,
                         const Matrix6d& of_picture = Matrix6d::Zero()) {
  const Matrix6d H = e.hessian() - of_picture;
  // The scene's distance: a turn moves it by this times the angle.
  const double lever_m = std::max(kMinLeverArm_m, std::sqrt(H.bottomRightCorner<3, 3>().trace() /
                                                            H.topLeftCorner<3, 3>().trace()));
  const double sigma_m = prior.sensor.sigma(static_cast<float>(lever_m));
  const double normal_noise = std::min(kMaxNormalNoise_rad, prior.normal_noise * sigma_m / lever_m);
  Vector6d scale = Vector6d::Ones();
  scale.tail<3>().setConstant(1.0 / lever_m);
  const Matrix6d S = scale.asDiagonal();
  const Matrix6d inverse_S = scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(S * H * S);
  const Vector6d& values = eigen.eigenvalues();
  const Matrix6d& V = eigen.eigenvectors();
  const double floor = normal_noise * normal_noise * values[5];
  Vector6d kept, inverse = Vector6d::Zero();
  ImageSystem system;
  for (int i = 0; i < 6; ++i) {
    kept[i] = values[i] > floor ? (values[i] - floor) / values[i] : 0.0;
    if (kept[i] > 0) inverse[i] = 1.0 / (share * (values[i] - floor));
    system.free_directions += kept[i] == 0.0 ? 1 : 0;
  }
  const Matrix6d keep = V * kept.asDiagonal() * V.transpose();
  system.H =
      share * inverse_S * V * values.cwiseProduct(kept).asDiagonal() * V.transpose() * inverse_S;
  system.inverse = S * V * inverse.asDiagonal() * V.transpose() * S;
  system.kept = share * inverse_S * keep * S;
  system.g = system.kept * e.gradient();
  return system;
}

/// Geman and McClure's weight of the prior, by how far the images' own answer lies from it (in
/// standard deviations of both: where the images say little, it may lie anywhere).
double weightOf(const Prior& prior, const ImageSystem& images, const Vector6d& error) {
  if (prior.is_firm) return 1.0;
  const Vector6d v = images.H * error - images.g;  // H times the answer, seen from the prior's
  const double distance2 =
      v.dot(images.inverse * v) - v.dot(solve(images.H + prior.information, v));
  const double root = 1.0 / (1.0 + std::max(0.0, distance2) / kPriorScale2);
  return root * root;
}

/// The images' word on the pose and the prior's.
struct PoseSystem {
  Matrix6d H;
  Vector6d g;
  double prior_weight = 1.0;
  int free_directions = 0;
};

PoseSystem combine(const ImageSystem& images, const Prior& prior,
                   const Eigen::Isometry3d& T_frame_view) {
  const Vector6d error = logSe3(T_frame_view * prior.T_frame_view.inverse());
  PoseSystem system;
  system.free_directions = images.free_directions;
  system.prior_weight = weightOf(prior, images, error);
  system.H = images.H + system.prior_weight * prior.information;
  system.g = images.g + system.prior_weight * prior.information * error;
  return system;
}

/// An alignment at work: the pose that fits best so far, and what was found there.
struct Alignment {
  Eigen::Isometry3d T_frame_view;
  TermSettings settings;
  NormalEquations equations;  ///< at T_frame_view
  double last_step = 0;
  int iterations = 0;
  bool solvable = true;
};

/// Colors that do not fit (a misplaced color camera, another exposure) say less: the scale of the
/// residuals is estimated, not assumed.
void adaptPhotometry(const NormalEquations& e, const TrackingConfig& config,
                     TermSettings& settings) {
  if (settings.photometric_sigma <= 0 || e.photometric_inliers <= 0) return;
  settings.brightness = e.fittedBrightness();
  settings.photometric_sigma = static_cast<float>(
      std::max(config.photometric_sigma, std::sqrt(e.photometric_error / e.photometric_inliers)));
}

/// What a step is to lower, per model point: the images' cost (Geman and McClure's) and the
/// prior's.
double objective(const NormalEquations& e, const Eigen::Isometry3d& T_frame_view, double share,
                 const Prior& prior, double prior_weight, const TermSettings& settings) {
  const Vector6d error = logSe3(T_frame_view * prior.T_frame_view.inverse());
  const double d2 = prior_weight * error.dot(prior.information * error);
  const double scale2 = settings.robust_scale * settings.robust_scale;
  return e.cost + d2 / (share * scale2 * std::max(1.0, e.cost_weight));
}

void alignLevel(const ModelPoints& model, const FrameLevel& frame, double share, const Prior& prior,
                const TrackingConfig& config, Alignment& a) {
  const auto evaluate = [&](const Eigen::Isometry3d& T) {
    ++a.iterations;
    return buildNormalEquations(model, frame, T, a.settings);
  };
  a.equations = evaluate(a.T_frame_view);
  for (int i = 1; i < config.max_iterations; ++i) {
    a.solvable = a.equations.inliers >= 6;
    if (!a.solvable) return;
    const PoseSystem system =
        combine(withoutNoise(a.equations, share, prior), prior, a.T_frame_view);
    Vector6d step = solve(system.H, -system.g);
    a.solvable = step.allFinite() && step.norm() < 1.0;
    if (!a.solvable) return;
    const double most =
        objective(a.equations, a.T_frame_view, share, prior, system.prior_weight, a.settings) +
        kCostNoise;
    // Brightness and the scale of its residuals settle first: only then do costs compare.
    const bool settled = i > 2;
    if (!settled) adaptPhotometry(a.equations, config, a.settings);
    Eigen::Isometry3d T = expSe3(step) * a.T_frame_view;
    NormalEquations next = evaluate(T);
    bool lower =
        !settled || objective(next, T, share, prior, system.prior_weight, a.settings) <= most;
    for (int k = 0; !lower && k < kMaxHalvings; ++k) {
      step *= 0.5;
      T = expSe3(step) * a.T_frame_view;
      next = evaluate(T);
      lower = objective(next, T, share, prior, system.prior_weight, a.settings) <= most;
    }
    a.last_step = step.norm();
    if (!lower) return;
    a.T_frame_view = T;
    a.equations = next;
    if (a.last_step < kSmallStep) return;
  }
}

/// What the sensor's errors that do not average out add to the covariance.
void addSystematic(const PlaceErrors& places, const ImageSystem& images, const Prior& prior,
                   TrackingResult& result) {
  const double held = result.prior_weight / kSameError_frames;
  const Matrix6d pull = solve(images.H + held * prior.information, images.kept);
  result.systematic = propagated(pull, places.gradient);
  result.distance_m = places.distance_m;
}

TrackingResult resultOf(const Alignment& a, const ImageSystem& images, const Prior& prior,
                        const Eigen::Isometry3d& T_map_view) {
  const NormalEquations& e = a.equations;
  TrackingResult result;
  result.T_map_camera = orthonormalised(T_map_view * a.T_frame_view.inverse());
  result.iterations = a.iterations;
  result.candidates = static_cast<int>(e.candidates);
  result.inliers = static_cast<int>(e.inliers);
  result.seen_through = static_cast<int>(e.seen_through);
  result.cost = e.cost;
  result.brightness = a.settings.brightness;
  if (e.inliers > 0) result.geometric_rmse_m = std::sqrt(e.geometric_error / e.inliers);
  if (e.photometric_inliers > 0) {
    result.photometric_rmse = std::sqrt(e.photometric_error / e.photometric_inliers);
  }
  if (!a.solvable) return result;
  const PoseSystem system = combine(images, prior, a.T_frame_view);
  result.free_directions = system.free_directions;
  result.prior_weight = system.prior_weight;
  result.converged = a.last_step < kConvergedStep;
  result.covariance = inverse(system.H);
  return result;
}

}  // namespace

TrackingResult track(const WorkingFrame& frame, const ModelPyramid& model,
                     const TrackingStart& start, const TrackingConfig& config) {
  Alignment a;
  a.settings.max_distance_m = static_cast<float>(config.max_distance_m);
  a.settings.min_normal_cosine = static_cast<float>(std::cos(config.max_normal_angle_rad));
  a.settings.photometric_sigma = static_cast<float>(config.photometric_sigma);
  a.settings.brightness = start.brightness;
  a.settings.sensor = frame.sensor;
  a.T_frame_view = start.T_map_camera.inverse() * start.T_map_view;
  const Prior prior{start.prior.T_map_camera.inverse() * start.T_map_view,
                    inverse(start.prior.covariance), start.prior_is_firm,
                    start.prior.is_measured ? kNormalNoise : kBlindNormalNoise, frame.sensor};
  const PinholeCamera& finest = frame.levels[0].camera;
  const double pixels_per_measurement = kMeasurement_sr * finest.fx * finest.fy;
  double share = 1.0;
  for (int i = kLevels - 1; i >= 0; --i) {
    // Coarse levels start further away: what is an outlier there may be an inlier later.
    a.settings.robust_scale = kRobustScale * static_cast<float>(1 << i);
    share = static_cast<double>(1 << (2 * i)) / pixels_per_measurement;
    alignLevel(model.level(i), frame.levels[i], share, prior, config, a);
  }
  const Matrix6d of_picture =
      noiseInformation(model.level(0), frame.levels[0], a.T_frame_view, a.settings);
  const ImageSystem images = withoutNoise(a.equations, share, prior, of_picture);
  TrackingResult result = resultOf(a, images, prior, start.T_map_view);
  if (a.solvable && start.with_systematic) {
    addSystematic(placeErrors(model.level(0), frame.levels[0], a.T_frame_view, a.settings), images,
                  prior, result);
  }
  return result;
}

}  // namespace pf
