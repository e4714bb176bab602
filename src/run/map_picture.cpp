// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/run/map_picture.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "posefusion/map/render.hpp"

namespace pf {
namespace {

constexpr int kMapWidth = 640;
constexpr int kMapHeight = 480;
const cv::Scalar kBackground(255, 255, 255);
const cv::Scalar kPathColor(220, 20, 60);

/// The range of the values without the outermost per cent on each side.
std::pair<double, double> rangeOf(std::vector<float> values) {
  const auto quantile = [&](double part) {
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return static_cast<double>(*at);
  };
  const double low = quantile(0.01);
  return {low, quantile(0.99)};
}

/// The box around the map and the path.
Eigen::AlignedBox3d boundsOf(const SurfelArrays& s, const Trajectory& trajectory) {
  const auto [x0, x1] = rangeOf(s.x);
  const auto [y0, y1] = rangeOf(s.y);
  const auto [z0, z1] = rangeOf(s.z);
  Eigen::AlignedBox3d box(Eigen::Vector3d(x0, y0, z0), Eigen::Vector3d(x1, y1, z1));
  for (const auto& pose : trajectory) {
    box.extend(Eigen::Vector3d(pose.T_world_camera.translation()));
  }
  return box;
}

PinholeCamera outsideCamera() {
  PinholeCamera camera;
  camera.width = kMapWidth;
  camera.height = kMapHeight;
  camera.fx = camera.fy = 620.0;
  camera.cx = 0.5 * (kMapWidth - 1);
  camera.cy = 0.5 * (kMapHeight - 1);
  return camera;
}

/// A camera that looks along `forward` at the whole map; `up` (not along `forward`) is up in the
/// picture.
Eigen::Isometry3d lookAt(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& forward,
                         const Eigen::Vector3d& up) {
  const double distance_m = std::max(0.5, 1.1 * box.diagonal().norm());
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d z = forward.normalized();
  const Eigen::Vector3d x = z.cross(up).normalized();
  T.linear() << x, z.cross(x), z;
  T.translation() = box.center() - distance_m * z;
  return T;
}

/// The surfels that do not turn their back on a viewer.
SurfelMap frontOf(const SurfelMap& map, const Eigen::Vector3d& viewer) {
  SurfelMap front = map;
  front.removeIf([&](const SurfelArrays& s, std::size_t i) {
    const Eigen::Vector3d to_viewer = viewer - Eigen::Vector3d(s.x[i], s.y[i], s.z[i]);
    return to_viewer.dot(Eigen::Vector3d(s.nx[i], s.ny[i], s.nz[i])) <= 0;
  });
  return front;
}

cv::Mat render(const SurfelMap& map, const PinholeCamera& camera, const Eigen::Isometry3d& T) {
  RenderOptions options;
  options.with_color = true;
  options.age = SurfelAge::all;
  ModelView view;
  SurfelRenderer().render(map, camera, T, options, view);
  cv::Mat picture = view.color.clone();
  picture.setTo(kBackground, view.depth_m == 0);
  return picture;
}

void drawPath(const Trajectory& trajectory, const PinholeCamera& camera,
              const Eigen::Isometry3d& T_map_camera, cv::Mat& picture) {
  std::vector<cv::Point> points;
  for (const auto& pose : trajectory) {
    const Eigen::Vector3d p = T_map_camera.inverse() * pose.T_world_camera.translation();
    if (p.z() < 0.1) continue;
    const Eigen::Vector2d pixel = camera.project(p);
    points.emplace_back(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
  }
  cv::polylines(picture, points, false, kPathColor, 2, cv::LINE_AA);
  if (!points.empty()) cv::circle(picture, points.back(), 5, kPathColor, -1, cv::LINE_AA);
}

cv::Mat drawFromOutside(const SurfelMap& map, const Trajectory& trajectory,
                        const Eigen::Isometry3d& T) {
  const PinholeCamera camera = outsideCamera();
  cv::Mat picture = render(frontOf(map, T.translation()), camera, T);
  drawPath(trajectory, camera, T, picture);
  return picture;
}

}  // namespace

cv::Mat drawMap(const SurfelMap& map, const Trajectory& trajectory, const PinholeCamera& camera) {
  SurfelMap stable = map;
  stable.removeFragments([](int fragment) { return fragment != kFirstFragment; });
  stable.removeIf([&](const SurfelArrays& s, std::size_t i) { return !map.isStable(s, i); });
  if (stable.size() == 0 || trajectory.empty()) return {};
  const Eigen::AlignedBox3d box = boundsOf(stable.collect(), trajectory);
  const Eigen::Matrix3d first = trajectory.front().T_world_camera.linear();
  const Eigen::Vector3d ahead = first.col(2), down = first.col(1), right = first.col(0);
  const Eigen::Vector3d slanted = 0.75 * down + ahead + 0.35 * right;

  std::vector<cv::Mat> pictures = {drawFromOutside(stable, trajectory, lookAt(box, down, ahead)),
                                   drawFromOutside(stable, trajectory, lookAt(box, slanted, -down)),
                                   render(stable, camera, trajectory.back().T_world_camera)};
  cv::resize(pictures[2], pictures[2], {camera.width * kMapHeight / camera.height, kMapHeight}, 0,
             0, cv::INTER_AREA);
  cv::Mat all;
  cv::hconcat(pictures, all);
  return all;
}

}  // namespace pf
