// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/view_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

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
constexpr double kNearest_m = 0.4;    // below it structured light is not specified
// Where the range of the sensor ends, of what is near its end only what is measured too near is
// left.
constexpr double kSigmasOfRange = 3.0;

/// Sums of a least-squares plane over a symmetric window, about its middle.
struct PlaneSums {
  double n = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0, w = 0, wu = 0, wv = 0, ww = 0;

  void add(double du, double dv, double inverse) {
    n += 1;
    u += du;
    v += dv;
    uu += du * du;
    uv += du * dv;
    vv += dv * dv;
    w += inverse;
    wu += inverse * du;
    wv += inverse * dv;
    ww += inverse * inverse;
  }
};

struct PlaneFit {
  Eigen::Vector3d plane;  ///< w, by_u, by_v
  double variance;        ///< of what is left
};

std::optional<PlaneFit> solve(const PlaneSums& s) {
  Eigen::Matrix3d A;
  A << s.n, s.u, s.v, s.u, s.uu, s.uv, s.v, s.uv, s.vv;
  const Eigen::Vector3d b(s.w, s.wu, s.wv);
  const double determinant = A.determinant();
  if (!(determinant > 1e-9 * s.n * s.n * s.n)) return std::nullopt;
  const Eigen::Vector3d plane = A.inverse() * b;
  return PlaneFit{plane, std::max(0.0, (s.ww - plane.dot(b)) / s.n)};
}

/// Standard deviation (1/m) of inverse depth of one measurement.
double inverseSigma(const DepthSensor& sensor, double w) {
  return sensor.sigma(static_cast<float>(1.0 / w)) * w * w;
}

bool isInRange(const DepthSensor& sensor, double w) {
  const double z = 1.0 / w;
  return w > 0 && z > kNearest_m &&
         z + kSigmasOfRange * sensor.sigma(static_cast<float>(z)) < sensor.max_depth_m;
}

std::optional<SurfacePatch> fitPatch(const CalibrationView& view, int u, int v, int radius) {
  const cv::Mat& depth_mm = view.depth_mm;
  const PinholeCamera& camera = view.camera;
  if (depth_mm.at<std::uint16_t>(v, u) == 0) return std::nullopt;
  PlaneSums sums;
  for (int dv = -radius; dv <= radius; ++dv) {
    const auto* row = depth_mm.ptr<std::uint16_t>(v + dv) + u;
    for (int du = -radius; du <= radius; ++du) {
      if (row[du] > 0) sums.add(du, dv, 1000.0 / row[du]);
    }
  }
  const double whole = (2.0 * radius + 1.0) * (2.0 * radius + 1.0);
  if (sums.n < kLeastFilled * whole) return std::nullopt;
  const auto fit = solve(sums);
  if (!fit || !isInRange(view.sensor, fit->plane[0])) return std::nullopt;
  const double sigma = inverseSigma(view.sensor, fit->plane[0]);
  if (fit->variance > sigma * sigma) return std::nullopt;  // an edge, or no plane
  SurfacePatch patch;
  patch.u = static_cast<float>(u);
  patch.v = static_cast<float>(v);
  patch.w = static_cast<float>(fit->plane[0]);
  patch.by_u = static_cast<float>(fit->plane[1]);
  patch.by_v = static_cast<float>(fit->plane[2]);
  patch.sigma = static_cast<float>(sigma / std::sqrt(std::max(1.0, sums.n * kIndependent)));
  const Eigen::Vector3d ray = camera.unproject(u, v, 1.0);
  if (-normalOf(patch, camera).dot(ray) < kGrazing * ray.norm()) return std::nullopt;
  return patch;
}

}  // namespace

Eigen::Vector3d normalOf(const SurfacePatch& p, const PinholeCamera& camera) {
  // 1 = n . X / distance in rays: w = A + B x + C y with x, y on the plane z = 1.
  const double B = p.by_u * camera.fx, C = p.by_v * camera.fy;
  const double A = p.w - p.by_u * (p.u - camera.cx) - p.by_v * (p.v - camera.cy);
  return -Eigen::Vector3d(B, C, A).normalized();
}

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
