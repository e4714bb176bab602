// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/background.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr float kMinViewDepth_m = 0.1F;  // nearer points of a view do not count
constexpr int kMinKnown = 4;       // of the 9 pixels looked at, for a verdict other than agreement
constexpr float kClearly = 2.0F;   // tolerances between surfaces that are surely not the same
constexpr double kMaxSteps = 4.0;  // of the last motion that the next one is predicted from

/// Difference of depth that noise, the map's error and the pose's explain, metres.
float depthTolerance(const DepthSensor& sensor, float z_m) {
  constexpr float kPose_m = 0.01F, kSigmas = 4.0F;
  return kPose_m + sensor.tolerance(z_m, kSigmas);
}

/// A rigid motion and a projection in floats.
struct Projection {
  Eigen::Matrix3f rotation;
  Eigen::Vector3f translation;
  float fx, fy, cx, cy;
};

/// Looks for a point of the grid's camera among the 3x3 pixels, `reach_px` apart, around its place
/// in the view.
Background comparePoint(const ModelView& view, const DepthSensor& sensor,
                        const Projection& projection, const Eigen::Vector3f& point, int reach_px) {
  const Eigen::Vector3f q = projection.rotation * point + projection.translation;
  if (q.z() <= kMinViewDepth_m) return Background::unknown;
  const float inverse_z = 1.0F / q.z();
  const int u = cvRound(projection.fx * q.x() * inverse_z + projection.cx);
  const int v = cvRound(projection.fy * q.y() * inverse_z + projection.cy);
  const cv::Mat& depth_m = view.depth_m;
  const float tolerance = depthTolerance(sensor, q.z());
  const auto isNear = [&](float model) { return std::abs(model - q.z()) < tolerance; };
  const auto isStable = [&](int x, int y) {
    return view.stable.empty() || view.stable.ptr<std::uint8_t>(y)[x] != 0;
  };
  // Nearly always the pixel in the middle says it all.
  if (u >= 0 && v >= 0 && u < depth_m.cols && v < depth_m.rows &&
      isNear(depth_m.ptr<float>(v)[u]) && isStable(u, v)) {
    return Background::agrees;
  }
  int known = 0, behind = 0, before = 0;
  bool recent = false;
  for (int y = v - reach_px; y <= v + reach_px; y += reach_px) {
    if (y < 0 || y >= depth_m.rows) continue;
    const auto* row = depth_m.ptr<float>(y);
    for (int x = u - reach_px; x <= u + reach_px; x += reach_px) {
      if (x < 0 || x >= depth_m.cols || !(row[x] > 0.0F)) continue;
      ++known;
      if (isNear(row[x])) {
        if (isStable(x, y)) return Background::agrees;
        recent = true;
      }
      behind += row[x] > q.z() + kClearly * tolerance;
      before += row[x] < q.z() - kClearly * tolerance;
    }
  }
  if (recent) return Background::recent;
  if (known >= kMinKnown && behind == known) return Background::nearer;
  if (known >= kMinKnown && before == known) return Background::farther;
  return Background::unknown;
}

}  // namespace

void compareWithModel(const SceneGrid& grid, const ModelView& view,
                      const Eigen::Isometry3d& T_view_camera, const DepthSensor& sensor,
                      std::vector<Background>& result) {
  result.assign(grid.size(), Background::unknown);
  const PinholeCamera& camera = view.camera;
  const Projection projection{
      T_view_camera.linear().cast<float>(), T_view_camera.translation().cast<float>(),
      static_cast<float>(camera.fx),        static_cast<float>(camera.fy),
      static_cast<float>(camera.cx),        static_cast<float>(camera.cy)};
  const int reach_px =
      std::max(1, static_cast<int>(std::lround(static_cast<double>(camera.width) / grid.cols)));
  parallelFor(grid.rows, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    const int last = static_cast<int>(end) * grid.cols;
    for (int cell = static_cast<int>(begin) * grid.cols; cell < last; ++cell) {
      if (!grid.hasDepth(cell)) continue;
      result[cell] = comparePoint(view, sensor, projection, grid.point(cell), reach_px);
    }
  });
}

Eigen::Isometry3d MotionPredictor::predict(const ModelView& view, std::int64_t stamp_ns) {
  if (frames_ == 0 || view.stamp_ns != newest_.stamp_ns) {
    before_ = newest_;
    newest_ = {view.stamp_ns, {view.fragment, view.T_uncorrected_camera()}};
    ++frames_;
  }
  Eigen::Isometry3d T_view_camera = Eigen::Isometry3d::Identity();
  const double last_step = static_cast<double>(newest_.stamp_ns - before_.stamp_ns);
  const double next_step = static_cast<double>(stamp_ns - newest_.stamp_ns);
  if (frames_ < 2 || last_step <= 0.0 || next_step <= 0.0) return T_view_camera;
  if (before_.pose.fragment != newest_.pose.fragment) return T_view_camera;
  const Eigen::Isometry3d T_before_view =
      before_.pose.T_map_camera.inverse() * newest_.pose.T_map_camera;
  const double steps = std::min(next_step / last_step, kMaxSteps);
  const Eigen::AngleAxisd turn(T_before_view.linear());
  T_view_camera.linear() = Eigen::AngleAxisd(turn.angle() * steps, turn.axis()).matrix();
  T_view_camera.translation() = steps * T_before_view.translation();
  return T_view_camera;
}

}  // namespace pf
