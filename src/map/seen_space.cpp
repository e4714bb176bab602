// SPDX-License-Identifier: BSD-3-Clause
#include "seen_space.hpp"

#include <algorithm>

namespace pf {
namespace {

constexpr int kCell_px = 4;
constexpr double kBetween_s = 0.5;
constexpr std::size_t kViews = 40;  // of 20 s
// One view may be of a pixel that mixes a rim with what is behind.
constexpr int kEnoughViews = 2;

/// The least of a cell of which at least half is known; 0 where it is not.
float leastOf(const cv::Mat& free_m, const cv::Rect& cell) {
  float least = 0;
  int known = 0;
  for (int v = cell.y; v < cell.y + cell.height; ++v) {
    const auto* row = free_m.ptr<float>(v);
    for (int u = cell.x; u < cell.x + cell.width; ++u) {
      if (row[u] <= 0) continue;
      least = known == 0 ? row[u] : std::min(least, row[u]);
      ++known;
    }
  }
  return 2 * known >= cell.area() ? least : 0.0F;
}

}  // namespace

void SeenSpace::add(const cv::Mat& free_m, const WorkingFrame& frame,
                    const Eigen::Isometry3d& T_map_camera, int fragment, std::int32_t map_frame) {
  if (!views_.empty() && map_frame - views_.back().map_frame < frame.pace.framesIn(kBetween_s)) {
    return;
  }
  View view{{}, frame.camera.shrunk(kCell_px), T_map_camera, fragment, map_frame};
  view.free_m.create(view.camera.height, view.camera.width, CV_32FC1);
  for (int v = 0; v < view.free_m.rows; ++v) {
    for (int u = 0; u < view.free_m.cols; ++u) {
      view.free_m.at<float>(v, u) =
          leastOf(free_m, {kCell_px * u, kCell_px * v, kCell_px, kCell_px});
    }
  }
  views_.push_back(std::move(view));
  if (views_.size() > kViews) views_.pop_front();
}

void SeenSpace::follow(const Deformation& deformation) {
  for (View& view : views_) {
    view.T_map_camera = deformation.at(view.map_frame, view.fragment) * view.T_map_camera;
    view.fragment = deformation.fragmentAfter(view.fragment);
  }
}

SeenSpace::FromCamera SeenSpace::from(const Eigen::Isometry3d& T_map_camera, int fragment) const {
  FromCamera from;
  for (const View& view : views_) {
    if (view.fragment != fragment) continue;
    const PinholeCamera& c = view.camera;
    from.views_.push_back({RigidMotion(view.T_map_camera.inverse() * T_map_camera),
                           static_cast<float>(c.fx), static_cast<float>(c.fy),
                           static_cast<float>(c.cx), static_cast<float>(c.cy), view.free_m});
  }
  return from;
}

bool SeenSpace::FromCamera::wasFree(float x, float y, float z, float behind_m) const {
  int free = 0;
  for (const Seen& seen : views_) {
    float vx, vy, vz;
    seen.T_view_camera.point(x, y, z, vx, vy, vz);
    if (vz <= 0) continue;
    const float u = seen.fx * vx / vz + seen.cx + 0.5F, v = seen.fy * vy / vz + seen.cy + 0.5F;
    const auto cols = static_cast<float>(seen.free_m.cols);
    const auto rows = static_cast<float>(seen.free_m.rows);
    if (!(u >= 0 && v >= 0 && u < cols && v < rows)) continue;
    const float reach_m = seen.free_m.ptr<float>(static_cast<int>(v))[static_cast<int>(u)];
    if (reach_m > vz + behind_m && ++free == kEnoughViews) return true;
  }
  return false;
}

}  // namespace pf
