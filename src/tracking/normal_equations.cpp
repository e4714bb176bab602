// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/normal_equations.hpp"

#include <algorithm>

#include "normal_equations_kernel.hpp"
#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

// In groups of lanes: 1024 points a task, whose float sums stay exact enough.
constexpr std::size_t kGroupGrain = 64;
constexpr double kMinGain = 0.25, kMaxGain = 4.0;

struct Sums {
  double value[kernel::kSums] = {};
  Sums& operator+=(const Sums& other) {
    for (int k = 0; k < kernel::kSums; ++k) value[k] += other.value[k];
    return *this;
  }
};

kernel::Image toKernel(const FrameLevel& frame) {
  kernel::Image image;
  image.depth = frame.depth_m.ptr<float>();
  image.nx = frame.normal_x.ptr<float>();
  image.ny = frame.normal_y.ptr<float>();
  image.nz = frame.normal_z.ptr<float>();
  image.intensity = frame.intensity.ptr<float>();
  image.width = frame.camera.width;
  image.height = frame.camera.height;
  image.fx = static_cast<float>(frame.camera.fx);
  image.fy = static_cast<float>(frame.camera.fy);
  image.cx = static_cast<float>(frame.camera.cx);
  image.cy = static_cast<float>(frame.camera.cy);
  return image;
}

kernel::Motion toKernel(const Eigen::Isometry3d& T) {
  kernel::Motion motion;
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) motion.r[3 * row + col] = static_cast<float>(T(row, col));
    motion.t[row] = static_cast<float>(T(row, 3));
  }
  return motion;
}

}  // namespace

NormalEquations buildNormalEquations(const ModelPoints& model, const FrameLevel& frame,
                                     const Eigen::Isometry3d& T_frame_model,
                                     const TermSettings& settings) {
  const kernel::Points points = {model.x.data(),         model.y.data(),     model.z.data(),
                                 model.nx.data(),        model.ny.data(),    model.nz.data(),
                                 model.intensity.data(), model.weight.data()};
  const kernel::Image image = toKernel(frame);
  const kernel::Motion motion = toKernel(T_frame_model);
  const kernel::Gates gates = {
      settings.max_distance_m,
      settings.min_normal_cosine,
      settings.robust_scale,
      settings.photometric_sigma > 0 ? 1.0F / settings.photometric_sigma : 0.0F,
      settings.brightness.gain,
      settings.brightness.offset,
      settings.sensor};
  constexpr std::size_t lanes = ModelPoints::kLanes;
  const std::size_t groups = (model.count + lanes - 1) / lanes;
  const Sums sums =
      deterministicSum<Sums>(groups, kGroupGrain, [&](std::size_t begin, std::size_t end) {
        Sums part;
        kernel::accumulate(points, image, motion, gates, begin * lanes, end * lanes, part.value);
        return part;
      });
  NormalEquations out;
  std::copy_n(sums.value, 21, out.H);
  std::copy_n(sums.value + 21, 6, out.g);
  out.geometric_error = sums.value[kernel::kGeometricError];
  out.photometric_error = sums.value[kernel::kPhotometricError];
  std::copy_n(sums.value + kernel::kBrightnessWeight, 5, out.brightness);
  out.cost_weight = sums.value[kernel::kCostWeight];
  out.cost = out.cost_weight > 0 ? sums.value[kernel::kCost] / out.cost_weight : 0.0;
  out.candidates = sums.value[kernel::kCandidates];
  out.inliers = sums.value[kernel::kInliers];
  out.photometric_inliers = sums.value[kernel::kPhotometricInliers];
  out.seen_through = sums.value[kernel::kSeenThrough];
  return out;
}

Matrix6d NormalEquations::hessian() const {
  Matrix6d full;
  int k = 0;
  for (int row = 0; row < 6; ++row) {
    for (int col = row; col < 6; ++col, ++k) full(row, col) = full(col, row) = H[k];
  }
  return full;
}

Brightness NormalEquations::fittedBrightness() const {
  const auto& [w, m, y, mm, my] = brightness;
  if (w <= 0) return {};
  // As if pixels of this contrast (grey levels) had been seen with gain 1.
  constexpr double kPriorContrast = 10.0;
  const double variance = mm / w - (m / w) * (m / w) + kPriorContrast * kPriorContrast;
  const double covariance = my / w - (m / w) * (y / w) + kPriorContrast * kPriorContrast;
  const double gain = std::clamp(covariance / variance, kMinGain, kMaxGain);
  return {static_cast<float>(gain), static_cast<float>(y / w - gain * m / w)};
}

Vector6d NormalEquations::gradient() const { return Eigen::Map<const Vector6d>(g); }

}  // namespace pf
