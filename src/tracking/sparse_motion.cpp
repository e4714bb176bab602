// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/sparse_motion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "surroundings.hpp"

namespace pf {
namespace {

constexpr int kMinMatches = 12;
constexpr int kMinNear = 6;  // with depth
constexpr double kMinInlierShare = 0.35;
constexpr int kRansacIterations = 100;
constexpr double kRansacConfidence = 0.995;
constexpr double kRansacError = 2.5;
constexpr int kMaxIterations = 10;
// Standard deviation of a corner's place; this and the other errors of places are in cornerPixel():
// the same angle in images of any size, as far as those have the pixels.
constexpr double kCornerSigma = 0.3;
// Corners without depth are mostly beyond the range of depth, by about so much. They tell of the
// turn, if little of the shift, and are used only where there are few others.
constexpr double kBeyond_m = 2.0;
constexpr double kFarSigma = 2.0;
constexpr int kEnoughNear = 30;
// Landmarks that were placed by poses gone astray agree less than this: the step from the frame
// before may then be the better answer.
constexpr double kHeldShare = 0.5;
constexpr double kCauchyScale = 1.0;  // standard deviations
constexpr double kInlierSigmas = 4.0;
// Errors that all corners share (the sensor's distortion, the rolling of edges) do not average out.
constexpr double kSharedTranslation_m = 0.003;
constexpr double kSharedRotation_rad = 0.0012;

/// Where a corner is in space, and where the later frame sees it.
struct Sight {
  Eigen::Vector3d before;  ///< m, in the earlier camera's frame
  Eigen::Vector2d after_px;
  double after_m = 0;        ///< depth in the later frame, 0 = not known
  double after_sigma_m = 0;  ///< of that depth
  bool is_far = false;       ///< without depth: taken to lie beyond the sensor's range
};

/// Does something stand at depth z (m) well before a stable surface of the map?
bool isBeforeMap(const FlowScene& scene, const PinholeCamera& camera, const cv::Point2f& pixel,
                 double z) {
  if (scene.view == nullptr) return false;
  const ModelView& view = *scene.view;
  const int u = static_cast<int>(pixel.x) * view.camera.width / camera.width;
  const int v = static_cast<int>(pixel.y) * view.camera.height / camera.height;
  if (u < 0 || v < 0 || u >= view.depth_m.cols || v >= view.depth_m.rows) return false;
  const float known = view.depth_m.at<float>(v, u);
  const bool stable = known > 0 && (view.stable.empty() || view.stable.at<std::uint8_t>(v, u) != 0);
  return stable && known - static_cast<float>(z) > 2.0F * scene.sensor.tolerance(known, 5.0F);
}

/// `landmarks` may be null: then all places come from the earlier frame's depth.
std::vector<Sight> sightsOf(const SparseFlow& flow, const FlowScene& scene,
                            const Landmarks* landmarks, const PinholeCamera& camera) {
  std::vector<Sight> sights;
  const Surroundings surroundings(scene.before_m, scene.before_still);
  const double far_m = scene.sensor.max_depth_m + kBeyond_m;
  const Eigen::Isometry3d T_before_map = scene.T_map_before.inverse();
  for (std::size_t i = 0; i < flow.before.size(); ++i) {
    const cv::Point2f &a = flow.before[i], &b = flow.after[i];
    const Landmark* known = landmarks == nullptr ? nullptr : landmarks->find(flow.ids[i]);
    if (known != nullptr && !known->isBelieved()) continue;
    if (known == nullptr && scene.before_m.empty()) continue;
    const CornerDepth around =
        scene.before_m.empty() ? CornerDepth{} : depthAround(scene.before_m, scene.sensor, a);
    const double z = around.z_m;
    if (z > 0 && isBeforeMap(scene, camera, a, z)) continue;
    Sight sight{camera.unproject(a.x, a.y, z > 0 ? z : far_m), {b.x, b.y}};
    if (known != nullptr) sight.before = T_before_map * known->at;
    sight.is_far = known == nullptr && z <= 0;
    if (sight.is_far && (around.is_edge || !surroundings.areOpen(a))) continue;
    if (!sight.is_far) sight.after_m = depthAround(scene.after_m, scene.sensor, b).z_m;
    sight.after_sigma_m = scene.sensor.sigma(static_cast<float>(sight.after_m));
    sights.push_back(sight);
  }
  return sights;
}

/// The later camera from the earlier one by P3P and RANSAC; false when nothing fits.
bool guess(const std::vector<Sight>& landmarks, const PinholeCamera& camera,
           Eigen::Isometry3d& T_after_before) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const Sight& l : landmarks) {
    points.emplace_back(l.before.x(), l.before.y(), l.before.z());
    pixels.emplace_back(l.after_px.x(), l.after_px.y());
  }
  const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const auto error_px = static_cast<float>(kRansacError * cornerPixel(camera.width));
  cv::Vec3d turn, shift;
  const auto ransac = [&](int method) {
    return cv::solvePnPRansac(points, pixels, K, cv::noArray(), turn, shift, false,
                              kRansacIterations, error_px, kRansacConfidence, cv::noArray(),
                              method);
  };
  // P3P finds no solution for some sets of points, EPnP needs two more of each set.
  if (!ransac(cv::SOLVEPNP_P3P) && !ransac(cv::SOLVEPNP_EPNP)) return false;
  T_after_before.linear() = expSo3({turn[0], turn[1], turn[2]});
  T_after_before.translation() = Eigen::Vector3d(shift[0], shift[1], shift[2]);
  return T_after_before.matrix().allFinite();
}

struct System {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double weighted = 0, weights = 0;  ///< sums of weighted squared residuals (in sigmas), of weights
  double squared_px = 0;
  int inliers = 0;
};

/// Adds J'wJ and J'wr of one residual in standard deviations.
void add(const Eigen::Matrix<double, 1, 6>& J, double r, double weight, System& system) {
  system.H += weight * J.transpose() * J;
  system.g += weight * J.transpose() * r;
  system.weighted += weight * r * r;
  system.weights += weight;
}

/// For the twist of T_after_before (update exp(twist) * T).
System build(const std::vector<Sight>& landmarks, const PinholeCamera& camera,
             const Eigen::Isometry3d& T) {
  const double corner_px = cornerPixel(camera.width);
  System system;
  for (const Sight& l : landmarks) {
    const Eigen::Vector3d q = T * l.before;
    if (q.z() < 0.1) continue;
    const double iz = 1.0 / q.z();
    const double sigma_px = corner_px * (l.is_far ? kFarSigma : kCornerSigma);
    const Eigen::Vector2d error = (camera.project(q) - l.after_px) / sigma_px;
    Eigen::Matrix<double, 3, 6> dq;
    dq << Eigen::Matrix3d::Identity(), -hat(q);
    Eigen::Matrix<double, 2, 3> dp;
    dp << camera.fx * iz, 0, -camera.fx * q.x() * iz * iz, 0, camera.fy * iz,
        -camera.fy * q.y() * iz * iz;
    double depth_error = 0, depth_sigma = 1;
    if (l.after_m > 0) {
      // Both depths are measured; the mean of nine pixels halves the noise, edges add to it.
      depth_sigma = 1.4 * l.after_sigma_m;
      depth_error = (q.z() - l.after_m) / depth_sigma;
    }
    const double distance2 = error.squaredNorm() + depth_error * depth_error;
    const double weight = 1.0 / (1.0 + distance2 / (kCauchyScale * kCauchyScale));
    const Eigen::Matrix<double, 2, 6> J = dp * dq / sigma_px;
    add(J.row(0), error.x(), weight, system);
    add(J.row(1), error.y(), weight, system);
    if (l.after_m > 0) add(dq.row(2) / depth_sigma, depth_error, weight, system);
    if (distance2 > kInlierSigmas * kInlierSigmas) continue;
    ++system.inliers;
    system.squared_px += error.squaredNorm() * sigma_px * sigma_px;
  }
  return system;
}

/// Least squares from a first guess; false when it leads nowhere.
bool refine(const std::vector<Sight>& landmarks, const PinholeCamera& camera, Eigen::Isometry3d& T,
            System& system) {
  for (int i = 0; i < kMaxIterations; ++i) {
    system = build(landmarks, camera, T);
    const Vector6d step = system.H.ldlt().solve(-system.g);
    if (!step.allFinite() || step.norm() > 1.0) return false;
    T = expSe3(step) * T;
    if (step.norm() < 1e-5) break;
  }
  return system.inliers >= kMinMatches &&
         system.inliers >= kMinInlierShare * static_cast<double>(landmarks.size());
}

SparseMotion estimate(std::vector<Sight> sights, const PinholeCamera& camera) {
  SparseMotion motion;
  const auto far =
      std::stable_partition(sights.begin(), sights.end(), [](const Sight& l) { return !l.is_far; });
  const auto near = far - sights.begin();
  if (near >= kEnoughNear) sights.erase(far, sights.end());
  motion.matches = static_cast<int>(sights.size());
  if (near < kMinNear || motion.matches < kMinMatches) return motion;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  System system;
  // RANSAC's answer can be a mirrored one where the corners lie in a plane.
  if (!guess(sights, camera, T) || !refine(sights, camera, T, system)) {
    T = Eigen::Isometry3d::Identity();
    if (!refine(sights, camera, T, system)) return motion;
  }
  motion.inliers = system.inliers;
  motion.found = true;
  motion.rmse_px = std::sqrt(system.squared_px / system.inliers);
  motion.T_before_after = T.inverse();
  // How much worse than assumed the corners are: blurred, of a misplaced color camera.
  const double scale = std::max(1.0, system.weighted / system.weights);
  motion.covariance = scale * system.H.ldlt().solve(Matrix6d::Identity());
  motion.covariance.diagonal().head<3>().array() += kSharedTranslation_m * kSharedTranslation_m;
  motion.covariance.diagonal().tail<3>().array() += kSharedRotation_rad * kSharedRotation_rad;
  return motion;
}

}  // namespace

SparseMotion estimateMotion(const SparseFlow& flow, const FlowScene& scene,
                            const PinholeCamera& camera) {
  const SparseMotion held = estimate(sightsOf(flow, scene, scene.landmarks, camera), camera);
  if (scene.landmarks == nullptr || (held.found && held.inliers >= kHeldShare * held.matches)) {
    return held;
  }
  const SparseMotion alone = estimate(sightsOf(flow, scene, nullptr, camera), camera);
  const bool held_is_better =
      held.found && alone.inliers * held.matches <= held.inliers * alone.matches;
  return held_is_better ? held : alone;
}

}  // namespace pf
