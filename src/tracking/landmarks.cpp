// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/landmarks.hpp"

#include <algorithm>
#include <cmath>

namespace pf {
namespace {

// Depth around a corner is the mean of what lies so many cornerPixel() around it, of which this
// share must be there.
constexpr double kReach = 2.0, kMinDepths = 0.12;
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

double smoothDepthAt(const cv::Mat& depth_m, const DepthSensor& sensor, const cv::Point2f& pixel) {
  const int u = static_cast<int>(std::lround(pixel.x)), v = static_cast<int>(std::lround(pixel.y));
  const int reach = static_cast<int>(std::lround(kReach * cornerPixel(depth_m.cols)));
  const int first_u = std::max(0, u - reach), last_u = std::min(depth_m.cols - 1, u + reach);
  const int first_v = std::max(0, v - reach), last_v = std::min(depth_m.rows - 1, v + reach);
  float least = 1e9F, most = 0.0F, sum = 0.0F;
  int count = 0;
  for (int row = first_v; row <= last_v; ++row) {
    const float* depth = depth_m.ptr<float>(row);
    for (int col = first_u; col <= last_u; ++col) {
      const float z = depth[col];
      if (z <= 0.0F) continue;
      least = std::min(least, z);
      most = std::max(most, z);
      sum += 1.0F / z;
      ++count;
    }
  }
  const int side = 2 * reach + 1;
  if (count < kMinDepths * side * side || most - least > sensor.tolerance(least, 4.0F)) return 0.0;
  return static_cast<double>(static_cast<float>(count) / sum);
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
    const double z = smoothDepthAt(seen.depth_m, seen.sensor, pixel);
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
