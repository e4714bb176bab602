// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/seen_surface.hpp"

#include <cmath>

#include "depth_tolerance.hpp"
#include "posefusion/core/parallel.hpp"
#include "posefusion/frame/depth_filter.hpp"

namespace pf {
namespace {

constexpr float kFacingOfView = 0.342F;  // 70 degrees
constexpr std::size_t kSamplesAtOnce = 4096;

}  // namespace

SeenSurface::SeenSurface(const SurfaceSamples& truth, const DepthSensor& sensor)
    : truth_(truth), sensor_(sensor), seen_(truth.positions.size(), 0) {}

void SeenSurface::add(const RgbdFrame& frame, const cv::Mat& mask,
                      const Eigen::Isometry3d& T_truth_camera) {
  depthInMetres(frame, sensor_.min_depth_m, sensor_.max_depth_m, depth_m_);
  const Eigen::Isometry3f T_camera_truth = T_truth_camera.inverse().cast<float>();
  const Eigen::Vector3f centre = T_truth_camera.translation().cast<float>();
  const auto fx = static_cast<float>(frame.camera.fx), fy = static_cast<float>(frame.camera.fy);
  const auto cx = static_cast<float>(frame.camera.cx), cy = static_cast<float>(frame.camera.cy);
  const auto sees = [&](const Eigen::Vector3f& position, const Eigen::Vector3f& normal) {
    const Eigen::Vector3f p = T_camera_truth * position, ray = centre - position;
    if (p.z() <= 0 || normal.dot(ray) < kFacingOfView * ray.norm()) return false;
    const long u = std::lround(fx * p.x() / p.z() + cx), v = std::lround(fy * p.y() / p.z() + cy);
    if (u < 0 || v < 0 || u >= depth_m_.cols || v >= depth_m_.rows) return false;
    const auto row = static_cast<int>(v), col = static_cast<int>(u);
    const float z = depth_m_.at<float>(row, col);
    if (z <= 0 || (!mask.empty() && mask.at<std::uint8_t>(row, col) != 0)) return false;
    return std::abs(z - p.z()) < depthTolerance(sensor_, z);
  };
  parallelFor(seen_.size(), kSamplesAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (sees(truth_.positions[i], truth_.normals[i])) ++seen_[i];
    }
  });
  ++views_;
}

SurfaceSamples SeenSurface::seenWell() const {
  SurfaceSamples samples;
  samples.radius_m = truth_.radius_m;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    if (seen_[i] < kViews) continue;
    samples.positions.push_back(truth_.positions[i]);
    samples.normals.push_back(truth_.normals[i]);
  }
  return samples;
}

}  // namespace pf
