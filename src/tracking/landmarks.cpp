// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/landmarks.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/inverse_plane.hpp"

namespace pf {
namespace {

// Depth around a corner is that of the plane through what lies so many cornerPixel() around it. It
// must be as sure as from this share of the depths there.
constexpr double kReach = 2.0, kMinDepths = 0.12;
// What a plane leaves of its depths is by chance up to so many standard deviations of the noise,
// and as much again (m) as surfaces are rough; a rim leaves a quarter of what it stands out by.
constexpr double kLeftOfPlane = 1.5, kRough_m = 0.0025;
// A corner that is elsewhere by more than this (cornerPixel()) in some frames (at 30 Hz) moves by
// itself.
constexpr double kMissed = 3.0;
constexpr float kMissedSigmas = 5.0F;
constexpr float kMostMisses = 3.0F;
// The mean forgets what is older than about so long: the place follows the map as fusion moves it.
constexpr double kMemory_s = 1.0;

/// Does a frame that sees a corner at `pixel`, at depth z (m), see it where the landmark is?
bool agrees(const Eigen::Vector3d& expected, const cv::Point2f& pixel, double z,
            const DepthPicture& seen) {
  if (expected.z() < 0.1) return false;
  const Eigen::Vector2d error = seen.camera.project(expected) - Eigen::Vector2d(pixel.x, pixel.y);
  return error.norm() < kMissed * cornerPixel(seen.camera.width) &&
         std::abs(expected.z() - z) < seen.sensor.tolerance(static_cast<float>(z), kMissedSigmas);
}

}  // namespace

CornerDepth depthAround(const cv::Mat& depth_m, const DepthSensor& sensor,
                        const cv::Point2f& pixel) {
  const int u = static_cast<int>(std::lround(pixel.x)), v = static_cast<int>(std::lround(pixel.y));
  const int reach = static_cast<int>(std::lround(kReach * cornerPixel(depth_m.cols)));
  const cv::Rect patch = cv::Rect(u - reach, v - reach, 2 * reach + 1, 2 * reach + 1);
  const cv::Rect seen = patch & cv::Rect({}, depth_m.size());
  InversePlaneSums sums;
  for (int row = seen.y; row < seen.y + seen.height; ++row) {
    const float* depth = depth_m.ptr<float>(row);
    for (int col = seen.x; col < seen.x + seen.width; ++col) {
      if (depth[col] > 0) sums.add(col - u, row - v, 1.0 / depth[col]);
    }
  }
  const auto plane = sums.fit();
  if (!plane || plane->support < kMinDepths * patch.area()) return {};
  if (plane->w <= 0) return {0, true};
  const double z = 1.0 / plane->w;
  const double left_m = std::sqrt(plane->variance) * z * z;
  const double noise_m = sensor.sigma(static_cast<float>(z));
  const bool is_plane = left_m < kLeftOfPlane * noise_m + kRough_m;
  return is_plane ? CornerDepth{z, false} : CornerDepth{0, true};
}

bool Landmark::isBelieved() const { return misses < kMostMisses; }

const Landmark* Landmarks::find(std::uint32_t id) const {
  const auto at = std::lower_bound(landmarks_.begin(), landmarks_.end(), id,
                                   [](const Landmark& l, std::uint32_t i) { return l.id < i; });
  return at != landmarks_.end() && at->id == id ? &*at : nullptr;
}

void Landmarks::update(const SparseFlow& flow, const DepthPicture& seen,
                       const Eigen::Isometry3d& T_map_camera, bool believed) {
  const Eigen::Isometry3d T_camera_map = T_map_camera.inverse();
  const double most_before = seen.pace.framesIn(kMemory_s) - 1.0;
  next_.clear();
  for (std::size_t i = 0; i < flow.ids.size(); ++i) {
    const cv::Point2f& pixel = flow.after[i];
    const double z = depthAround(seen.depth_m, seen.sensor, pixel).z_m;
    const Landmark* known = find(flow.ids[i]);
    if (known == nullptr && z <= 0) continue;
    Landmark landmark = known != nullptr ? *known : Landmark{flow.ids[i]};
    if (z > 0 && (known == nullptr || believed)) {
      const bool right = known == nullptr || agrees(T_camera_map * known->at, pixel, z, seen);
      const double sigma_m = seen.sensor.sigma(static_cast<float>(z));
      const double weight = 1.0 / (sigma_m * sigma_m);
      landmark.misses += right ? 0.0F : seen.pace.worth();
      landmark.weight = std::min(landmark.weight, most_before * weight);
      if (right) {
        const Eigen::Vector3d at = T_map_camera * seen.camera.unproject(pixel.x, pixel.y, z);
        landmark.at = (landmark.weight * landmark.at + weight * at) / (landmark.weight + weight);
        landmark.weight += weight;
      }
    }
    next_.push_back(landmark);
  }
  landmarks_.swap(next_);
}

void Landmarks::move(const Eigen::Isometry3d& T_new_old) {
  for (Landmark& l : landmarks_) l.at = T_new_old * l.at;
}

}  // namespace pf
