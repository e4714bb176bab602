// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/view_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "posefusion/core/inverse_plane.hpp"

namespace pf {
namespace {

constexpr int kColumns = 80;  // of patches
// A window is 7 steps wide in an image of 4 pixels a step: large enough to average the noise, small
// against furniture.
constexpr double kRadiusSteps = 0.75;
// The pattern is matched in windows of some pixels: of a window's depths about a twelfth are
// independent (Khoshelham and Elberink 2012 describe the matching; measured on the simulator).
constexpr double kIndependent = 1.0 / 12.0;
constexpr double kLeastFilled = 0.8;  // part of a window that has depth
constexpr double kGrazing = 0.25;     // cosine between view and normal
// What a plane leaves of a window, in variances of the noise. Of depth as measured it is one on
// average, more in half of all windows; an edge leaves many.
constexpr double kMostOfPlane = 3.0;
constexpr double kNearestDepth_m = 0.4;  // below it structured light is not specified
// Where the range of the sensor ends, of what is near its end only what is measured too near is
// left.
constexpr double kSigmasOfRange = 3.0;

/// Standard deviation (1/m) of inverse depth of one measurement.
double inverseSigma(const DepthSensor& sensor, double w) {
  return sensor.sigma(static_cast<float>(1.0 / w)) * w * w;
}

bool isInRange(const DepthSensor& sensor, double w) {
  const double z = 1.0 / w;
  return w > 0 && z > kNearestDepth_m &&
         z + kSigmasOfRange * sensor.sigma(static_cast<float>(z)) < sensor.max_depth_m;
}

Eigen::Vector3d normalOf(const SurfacePatch& p, const PinholeCamera& camera) {
  // 1 = n . X / distance in rays: w = A + B x + C y with x, y on the plane z = 1.
  const double B = p.by_u * camera.fx, C = p.by_v * camera.fy;
  const double A = p.w - p.by_u * (p.u - camera.cx) - p.by_v * (p.v - camera.cy);
  return -Eigen::Vector3d(B, C, A).normalized();
}

std::optional<SurfacePatch> fitPatch(const CalibrationView& view, int u, int v, int radius) {
  const cv::Mat& depth_mm = view.depth_mm;
  const PinholeCamera& camera = view.camera;
  if (depth_mm.at<std::uint16_t>(v, u) == 0) return std::nullopt;
  InversePlaneSums sums;
  for (int dv = -radius; dv <= radius; ++dv) {
    const auto* row = depth_mm.ptr<std::uint16_t>(v + dv) + u;
    for (int du = -radius; du <= radius; ++du) {
      if (row[du] > 0) sums.add(du, dv, 1000.0 / row[du]);
    }
  }
  const double whole = (2.0 * radius + 1.0) * (2.0 * radius + 1.0);
  if (sums.count() < kLeastFilled * whole) return std::nullopt;
  const auto fit = sums.fit();
  if (!fit || !isInRange(view.sensor, fit->w)) return std::nullopt;
  const double sigma = inverseSigma(view.sensor, fit->w);
  if (fit->variance > kMostOfPlane * sigma * sigma) return std::nullopt;
  SurfacePatch patch;
  patch.u = static_cast<float>(u);
  patch.v = static_cast<float>(v);
  patch.w = static_cast<float>(fit->w);
  patch.by_u = static_cast<float>(fit->by_u);
  patch.by_v = static_cast<float>(fit->by_v);
  patch.sigma = static_cast<float>(sigma / std::sqrt(std::max(1.0, sums.count() * kIndependent)));
  const Eigen::Vector3d ray = camera.unproject(u, v, 1.0);
  const Eigen::Vector3d normal = normalOf(patch, camera);
  if (-normal.dot(ray) < kGrazing * ray.norm()) return std::nullopt;
  patch.normal = normal.cast<float>();
  return patch;
}

}  // namespace

ViewSurface::ViewSurface(const CalibrationView& view)
    : id_(view.id),
      camera_(view.camera),
      T_map_camera_(view.T_map_camera),
      fragment_(view.fragment) {
  const cv::Mat& depth = view.depth_mm;
  step_ = std::max(1, static_cast<int>(std::lround(depth.cols / static_cast<double>(kColumns))));
  radius_ = std::max(1, static_cast<int>(std::lround(kRadiusSteps * step_)));
  columns_ = (depth.cols - 2 * radius_ - 1) / step_ + 1;
  rows_ = (depth.rows - 2 * radius_ - 1) / step_ + 1;
  if (depth.cols < 2 * radius_ + 1 || depth.rows < 2 * radius_ + 1) columns_ = rows_ = 0;
  for (int row = 0; row < rows_; ++row) {
    for (int col = 0; col < columns_; ++col) {
      const auto patch = fitPatch(view, radius_ + col * step_, radius_ + row * step_, radius_);
      index_.push_back(patch ? static_cast<int>(patches_.size()) : -1);
      if (patch) patches_.push_back(*patch);
    }
  }
}

const SurfacePatch* ViewSurface::near(double u, double v) const {
  const double col = (u - radius_) / step_ + 0.5, row = (v - radius_) / step_ + 0.5;
  if (!(col >= 0 && row >= 0 && col < columns_ && row < rows_)) return nullptr;
  const int index = index_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                           static_cast<std::size_t>(col)];
  return index < 0 ? nullptr : &patches_[static_cast<std::size_t>(index)];
}

}  // namespace pf
