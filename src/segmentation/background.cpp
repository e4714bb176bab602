// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/background.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

/// Difference of depth that noise, the map's error and the pose's explain, metres: the noise of
/// structured light grows with the square of the depth.
float depthTolerance(float z) { return 0.02F + 0.006F * z * z; }

/// A rigid motion and a projection in floats.
struct Projection {
  Eigen::Matrix3f rotation;
  Eigen::Vector3f translation;
  float fx, fy, cx, cy;
};

Background judge(const ModelView& view, const Projection& projection, const Eigen::Vector3f& point,
                 int reach_px) {
  const Eigen::Vector3f q = projection.rotation * point + projection.translation;
  if (q.z() <= 0.1F) return Background::unknown;
  const int u = static_cast<int>(std::lround(projection.fx * q.x() / q.z() + projection.cx));
  const int v = static_cast<int>(std::lround(projection.fy * q.y() / q.z() + projection.cy));
  const cv::Mat& depth_m = view.depth_m;
  const float tolerance = depthTolerance(q.z());
  int known = 0, behind = 0, before = 0;
  bool recent = false;
  for (int dy = -reach_px; dy <= reach_px; dy += reach_px) {
    const int y = v + dy;
    if (y < 0 || y >= depth_m.rows) continue;
    for (int dx = -reach_px; dx <= reach_px; dx += reach_px) {
      const int x = u + dx;
      if (x < 0 || x >= depth_m.cols) continue;
      const float model = depth_m.at<float>(y, x);
      if (!(model > 0.0F)) continue;
      ++known;
      if (std::abs(model - q.z()) < tolerance) {
        if (view.stable.empty() || view.stable.at<std::uint8_t>(y, x) != 0) {
          return Background::agrees;
        }
        recent = true;
      }
      behind += model > q.z() + 2.0F * tolerance;
      before += model < q.z() - 2.0F * tolerance;
    }
  }
  if (recent) return Background::recent;
  if (known >= 4 && behind == known) return Background::nearer;
  if (known >= 4 && before == known) return Background::farther;
  return Background::unknown;
}

}  // namespace

void compareWithModel(const SceneGrid& grid, const ModelView& view,
                      const Eigen::Isometry3d& T_view_camera, std::vector<Background>& result) {
  result.assign(grid.size(), Background::unknown);
  const PinholeCamera& camera = view.camera;
  const Projection projection{
      T_view_camera.linear().cast<float>(), T_view_camera.translation().cast<float>(),
      static_cast<float>(camera.fx),        static_cast<float>(camera.fy),
      static_cast<float>(camera.cx),        static_cast<float>(camera.cy)};
  const int reach_px =
      std::max(1, static_cast<int>(std::lround(static_cast<double>(camera.width) / grid.cols)));
  parallelFor(grid.rows, 8, [&](std::size_t begin, std::size_t end) {
    const int last = static_cast<int>(end) * grid.cols;
    for (int cell = static_cast<int>(begin) * grid.cols; cell < last; ++cell) {
      if (!grid.hasDepth(cell)) continue;
      result[cell] = judge(view, projection, {grid.x[cell], grid.y[cell], grid.z[cell]}, reach_px);
    }
  });
}

Eigen::Isometry3d MotionPredictor::predict(const ModelView& view, std::int64_t stamp_ns) {
  Eigen::Isometry3d T_view_camera = Eigen::Isometry3d::Identity();
  const double last_step = static_cast<double>(view_stamp_ns_ - other_stamp_ns_);
  const double next_step = static_cast<double>(stamp_ns - view_stamp_ns_);
  if (frames_ >= 2 && last_step > 0 && next_step > 0 && next_step < 4 * last_step) {
    const Eigen::Isometry3d T_other_view = T_map_other_.inverse() * view.T_map_camera;
    const double factor = std::min(next_step / last_step, 2.0);
    const Eigen::AngleAxisd turn(T_other_view.linear());
    T_view_camera.linear() = Eigen::AngleAxisd(turn.angle() * factor, turn.axis()).matrix();
    T_view_camera.translation() = factor * T_other_view.translation();
  }
  T_map_other_ = view.T_map_camera;
  other_stamp_ns_ = view_stamp_ns_;
  view_stamp_ns_ = stamp_ns;
  ++frames_;
  return T_view_camera;
}

}  // namespace pf
