// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/sparse_motion.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "sight_motion.hpp"
#include "surroundings.hpp"

namespace pf {
namespace {

constexpr int kMinMatches = 12;
constexpr int kMinNear = 6;  // with depth
constexpr double kMinInlierShare = 0.35;
constexpr int kRansacIterations = 100;
constexpr double kRansacConfidence = 0.995;
constexpr double kRansacError = 2.5;  // cornerPixel()
// Corners without depth measure the turn and the direction of the shift, and are used only where
// there are few others. Beside a surface nearer than this (m) they may be too near for the sensor.
constexpr double kOpen_m = 1.5;
constexpr int kEnoughNear = 30;
// Landmarks that were placed by poses gone astray agree less than this: the step from the frame
// before may then be the better answer.
constexpr double kHeldShare = 0.5;
// Errors that all corners share (the sensor's distortion, the rolling of edges) do not average out.
constexpr double kSharedTranslation_m = 0.003;
constexpr double kSharedRotation_rad = 0.0012;
// How fast the speed of a camera on a robot or in a hand changes (standard deviation).
constexpr double kSpeedChange_m_s2 = 5.0;
constexpr double kTurnChange_rad_s2 = 10.0;
// Where a corner's window shows part of a person, it follows that person a little: errors are so
// much larger (median, simulated crowd: 0.55 and 0.23 px).
constexpr double kBesidePerson = 2.5;
// See SparseMotion::isSure().
constexpr int kSureInliers = 40;
constexpr double kSureShare = 0.5;

/// The pixel of an image of another size that shows the same; may lie outside.
cv::Point pixelIn(const cv::Size& size, const PinholeCamera& camera, const cv::Point2f& pixel) {
  return {static_cast<int>(pixel.x) * size.width / camera.width,
          static_cast<int>(pixel.y) * size.height / camera.height};
}

/// How far the map's stable surface is that the earlier camera would see at a pixel (m); 0: none.
float mappedAt(const FlowScene& scene, const PinholeCamera& camera, const cv::Point2f& pixel) {
  if (scene.view == nullptr) return 0.0F;
  const ModelView& view = *scene.view;
  const cv::Point at = pixelIn({view.camera.width, view.camera.height}, camera, pixel);
  if (!cv::Rect({}, view.depth_m.size()).contains(at)) return 0.0F;
  const bool stable = view.stable.empty() || view.stable.at<std::uint8_t>(at) != 0;
  return stable ? view.depth_m.at<float>(at) : 0.0F;
}

/// Does something stand well before the map at a corner? What has no depth (z = 0) where the map
/// was measured time and again is too near for the sensor.
bool isBeforeMap(const DepthSensor& sensor, float mapped_m, double z) {
  return mapped_m > 0 && mapped_m - static_cast<float>(z) > 2.0F * sensor.tolerance(mapped_m, 5.0F);
}

/// Where the windows of corners show no part of a person: CV_8UC1, 0 elsewhere. Pixels of `still`
/// count for the window beside them: of the localiser's, an eightieth of the picture's width, so
/// that 3x3 are about a window.
cv::Mat apartFromPeople(const cv::Mat& still) {
  cv::Mat apart;
  if (!still.empty()) cv::erode(still, apart, cv::Mat());
  return apart;
}

bool isBesidePerson(const cv::Mat& apart, const PinholeCamera& camera, const cv::Point2f& pixel) {
  const cv::Point at = pixelIn(apart.size(), camera, pixel);
  return cv::Rect({}, apart.size()).contains(at) && apart.at<std::uint8_t>(at) == 0;
}

/// `landmarks` may be null: then all places come from the earlier frame's depth.
std::vector<Sight> sightsOf(const SparseFlow& flow, const FlowScene& scene,
                            const Landmarks* landmarks, const PinholeCamera& camera) {
  std::vector<Sight> sights;
  std::optional<Surroundings> surroundings;  // few frames ask for them
  const cv::Mat apart = apartFromPeople(scene.before_still);
  const Eigen::Isometry3d T_before_map = scene.T_map_before.inverse();
  for (std::size_t i = 0; i < flow.before.size(); ++i) {
    const cv::Point2f &a = flow.before[i], &b = flow.after[i];
    const Landmark* known = landmarks == nullptr ? nullptr : landmarks->find(flow.ids[i]);
    if (known != nullptr && !known->isBelieved()) continue;
    if (known == nullptr && scene.before_m.empty()) continue;
    const CornerDepth around =
        scene.before_m.empty() ? CornerDepth{} : depthAround(scene.before_m, scene.sensor, a);
    const double z = around.z_m;
    // A landmark without depth has its place all the same.
    if ((known == nullptr || z > 0) && isBeforeMap(scene.sensor, mappedAt(scene, camera, a), z)) {
      continue;
    }
    Sight sight{camera.unproject(a.x, a.y, z), {b.x, b.y}};
    if (known != nullptr) sight.before = T_before_map * known->at;
    if (known == nullptr && z <= 0) {
      if (!surroundings) surroundings.emplace(scene.before_m, scene.before_still);
      const double beside_m = around.is_edge ? 0.0 : surroundings->depthBeside(a);
      if (beside_m <= kOpen_m) continue;
      sight.before = camera.unproject(a.x, a.y, 1.0);
      sight.far_inverse = 0.5 / beside_m;
    } else {
      sight.after_m = depthAround(scene.after_m, scene.sensor, b).z_m;
    }
    if (isBesidePerson(apart, camera, a)) sight.spread = kBesidePerson;
    sight.after_sigma_m = scene.sensor.sigma(static_cast<float>(sight.after_m));
    sights.push_back(sight);
  }
  return sights;
}

/// The later camera from the earlier one by P3P and RANSAC over what has depth; false when nothing
/// fits.
bool guess(const std::vector<Sight>& landmarks, const PinholeCamera& camera,
           Eigen::Isometry3d& T_after_before) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const Sight& l : landmarks) {
    if (!l.hasDepth()) continue;
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

/// Looks for motions that the sights agree on, and keeps the likeliest.
class MotionSearch {
 public:
  MotionSearch(const std::vector<Sight>& sights, const PinholeCamera& camera,
               const std::optional<ExpectedStep>& expected)
      : sights_(sights), camera_(camera), expected_(expected) {}

  /// Near the expected motion first, and elsewhere where less than half of the sights agree on it.
  const std::optional<SightMotion>& search() {
    if (expected_) tryFrom(expected_->T_before_after.inverse());
    if (best_ && best_->inliers >= shareOf(kHeldShare)) return best_;
    Eigen::Isometry3d T_after_before;
    if (guess(sights_, camera_, T_after_before)) tryFrom(T_after_before);
    // RANSAC's answer can be a mirrored one where the corners lie in a plane.
    if (!best_) tryFrom(Eigen::Isometry3d::Identity());
    return best_;
  }

 private:
  void tryFrom(const Eigen::Isometry3d& T_after_before) {
    SightMotion motion;
    motion.T_after_before = T_after_before;
    if (!fitMotion(sights_, camera_, expected_, motion)) return;
    if (motion.inliers < kMinMatches || motion.inliers < shareOf(kMinInlierShare)) return;
    if (!best_ || motion.cost < best_->cost) best_ = motion;
  }

  double shareOf(double share) const { return share * static_cast<double>(sights_.size()); }

  const std::vector<Sight>& sights_;
  const PinholeCamera& camera_;
  const std::optional<ExpectedStep>& expected_;
  std::optional<SightMotion> best_;
};

SparseMotion estimate(std::vector<Sight> sights, const PinholeCamera& camera,
                      const std::optional<ExpectedStep>& expected) {
  SparseMotion motion;
  const auto far = std::stable_partition(sights.begin(), sights.end(),
                                         [](const Sight& l) { return l.hasDepth(); });
  const auto near = far - sights.begin();
  if (near >= kEnoughNear) sights.erase(far, sights.end());
  motion.matches = static_cast<int>(sights.size());
  if (near < kMinNear || motion.matches < kMinMatches) return motion;
  MotionSearch search(sights, camera, expected);
  const std::optional<SightMotion>& best = search.search();
  if (!best) return motion;
  motion.inliers = best->inliers;
  motion.found = true;
  motion.rmse_px = std::sqrt(best->squared_px / best->inliers);
  motion.T_before_after = best->T_after_before.inverse();
  motion.covariance = best->covariance;
  motion.covariance.diagonal().head<3>().array() += kSharedTranslation_m * kSharedTranslation_m;
  motion.covariance.diagonal().tail<3>().array() += kSharedRotation_rad * kSharedRotation_rad;
  return motion;
}

}  // namespace

bool SparseMotion::isSure() const {
  return found && inliers >= kSureInliers && inliers >= kSureShare * matches;
}

ExpectedStep steadyStep(const Eigen::Isometry3d& T_before_after, double step_s, double since_s) {
  return {T_before_after, independentCovariance(kSpeedChange_m_s2 * since_s * step_s,
                                                kTurnChange_rad_s2 * since_s * step_s)};
}

SparseMotion estimateMotion(const SparseFlow& flow, const FlowScene& scene,
                            const PinholeCamera& camera) {
  const auto from = [&](const Landmarks* landmarks) {
    return estimate(sightsOf(flow, scene, landmarks, camera), camera, scene.expected);
  };
  const SparseMotion held = from(scene.landmarks);
  if (scene.landmarks == nullptr || (held.found && held.inliers >= kHeldShare * held.matches)) {
    return held;
  }
  const SparseMotion alone = from(nullptr);
  const bool held_is_better =
      held.found && alone.inliers * held.matches <= held.inliers * alone.matches;
  return held_is_better ? held : alone;
}

}  // namespace pf
