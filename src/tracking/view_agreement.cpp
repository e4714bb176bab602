// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/view_agreement.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/symmetric.hpp"

namespace pf {
namespace {

constexpr float kAgreeingSigmas = 4.0F;
constexpr float kMinNormalCosine = 0.7F;
// Grey levels are compared in windows of so many pixels: light and exposure change slowly. So are
// normals: those of single pixels are noise where the depth is, far away and in small pictures.
constexpr int kWindow = 16;
constexpr double kLeastPixels = 0.3;     // of a window
constexpr double kLeastVariance = 40.0;  // of grey levels: less texture is not compared

/// Sums over a window: of grey levels, for the correlation, and of where the depths agree.
struct WindowSums {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  double agreeing = 0;                                                               ///< pixels
  Eigen::Vector3f seen = Eigen::Vector3f::Zero(), mapped = Eigen::Vector3f::Zero();  ///< normals
  Eigen::Matrix3f outer = Eigen::Matrix3f::Zero();  ///< products of the map's normals

  void add(double x, double y) { n += 1, a += x, b += y, aa += x * x, bb += y * y, ab += x * y; }

  void addNormals(const Eigen::Vector3f& of_frame, const Eigen::Vector3f& of_map) {
    agreeing += 1;
    outer += of_map * of_map.transpose();
    if (of_frame.z() >= 0) return;  // not known
    seen += of_frame;
    mapped += of_map;
  }

  /// The surfaces face one way, as far as it is known.
  bool isParallel() const {
    return seen.isZero() || seen.dot(mapped) >= kMinNormalCosine * seen.norm() * mapped.norm();
  }
};

/// The windows' correlations, weighted by their texture; 0 where there is none.
double correlationOf(const std::vector<WindowSums>& windows) {
  double both = 0, texture = 0;
  for (const WindowSums& w : windows) {
    if (w.n < kLeastPixels * kWindow * kWindow) continue;
    const double va = w.aa / w.n - w.a * w.a / (w.n * w.n);
    const double vb = w.bb / w.n - w.b * w.b / (w.n * w.n);
    if (std::max(va, vb) < kLeastVariance) continue;
    const double root = std::sqrt(std::max(0.0, va * vb));
    both += w.ab / w.n - w.a * w.b / (w.n * w.n);
    texture += std::max(root, 0.5 * std::max(va, vb));
  }
  return texture > 0 ? both / texture : 0.0;
}

/// Pixels.
struct Counts {
  double valid = 0, known = 0, through = 0, hidden = 0;
};

/// One row; `windows` are those that it crosses.
void compareRow(const WorkingFrame& frame, const ModelView& view, int v, WindowSums* windows,
                Counts& counts) {
  const FrameLevel& level = frame.levels[0];
  const DepthSensor sensor = frame.sensor;
  const auto *seen = level.depth_m.ptr<float>(v), *model = view.depth_m.ptr<float>(v);
  const auto *ax = level.normal_x.ptr<float>(v), *ay = level.normal_y.ptr<float>(v);
  const auto *az = level.normal_z.ptr<float>(v), *bx = view.normal_x.ptr<float>(v);
  const auto *by = view.normal_y.ptr<float>(v), *bz = view.normal_z.ptr<float>(v);
  const auto *grey = level.intensity.ptr<float>(v), *mapped = view.intensity.ptr<float>(v);
  const auto* still = level.still.ptr<std::uint8_t>(v);
  for (int u = 0; u < level.depth_m.cols; ++u) {
    if (seen[u] <= 0) continue;
    ++counts.valid;
    if (model[u] <= 0) continue;
    ++counts.known;
    const float nz = std::min(-0.2F, bz[u]);
    const float tolerance = sensor.tolerance(std::max(seen[u], model[u]), kAgreeingSigmas) / -nz;
    if (seen[u] > model[u] + tolerance) ++counts.through;
    if (seen[u] < model[u] - tolerance) ++counts.hidden;
    if (std::abs(seen[u] - model[u]) > tolerance) continue;
    WindowSums& window = windows[u / kWindow];
    window.addNormals({ax[u], ay[u], az[u]}, {bx[u], by[u], bz[u]});
    if (still[u] != 0) window.add(grey[u], mapped[u]);
  }
}

}  // namespace

ViewAgreement compareViews(const WorkingFrame& frame, const ModelView& view) {
  const FrameLevel& level = frame.levels[0];
  const int across = (level.depth_m.cols + kWindow - 1) / kWindow;
  const int down = (level.depth_m.rows + kWindow - 1) / kWindow;
  std::vector<WindowSums> windows(static_cast<std::size_t>(across * down));
  Counts counts;
  for (int v = 0; v < level.depth_m.rows; ++v) {
    compareRow(frame, view, v, &windows[static_cast<std::size_t>(v / kWindow * across)], counts);
  }
  ViewAgreement result;
  result.view = counts.valid / static_cast<double>(level.depth_m.total());
  result.overlap = counts.known / std::max(1.0, counts.valid);
  double agreeing = 0;
  Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
  for (const WindowSums& window : windows) {
    if (!window.isParallel()) continue;
    agreeing += window.agreeing;
    normals += window.outer.cast<double>();
  }
  result.agreeing = agreeing / std::max(1.0, counts.known);
  result.seen_through = counts.through / std::max(1.0, counts.known);
  result.hidden = counts.hidden / std::max(1.0, counts.known);
  result.correlation = correlationOf(windows);
  result.spread = eigenOf(normals / std::max(1.0, agreeing)).values[0];
  return result;
}

}  // namespace pf
