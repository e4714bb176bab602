// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/grid/keyframe_rays.hpp"

namespace pf {
namespace {

constexpr int kShrink = 4;

}  // namespace

KeyframeRays::KeyframeRays(const PinholeCamera& camera)
    : camera_(camera.withoutDistortion().shrunk(kShrink)) {}

const cv::Mat& KeyframeRays::draw(const SurfelMap& map, const Eigen::Isometry3d& T_map_camera) {
  RenderOptions options;
  options.only_stable = true;
  options.age = SurfelAge::all;
  renderer_.render(map, camera_, T_map_camera, options, view_);
  return view_.depth_m;
}

SeenPoints KeyframeRays::points(const cv::Mat& depth_m,
                                const Eigen::Isometry3d& T_map_camera) const {
  SeenPoints seen;
  seen.from = T_map_camera.translation().cast<float>();
  for (int v = 0; v < depth_m.rows; ++v) {
    for (int u = 0; u < depth_m.cols; ++u) {
      const float z = depth_m.at<float>(v, u);
      if (z <= 0) continue;
      seen.points.push_back((T_map_camera * camera_.unproject(u, v, z)).cast<float>());
    }
  }
  return seen;
}

void forEachKeyframe(const SurfelMap& map, const PinholeCamera& camera,
                     const std::vector<Keyframe>& keyframes,
                     const std::function<void(const SeenPoints&)>& visit) {
  KeyframeRays rays(camera);
  for (const Keyframe& keyframe : keyframes) {
    if (keyframe.fragment != kFirstFragment) continue;
    visit(rays.points(rays.draw(map, keyframe.T_map_camera), keyframe.T_map_camera));
  }
}

}  // namespace pf
