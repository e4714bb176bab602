// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/grid/keyframe_rays.hpp"

#include "posefusion/map/render.hpp"

namespace pf {
namespace {

constexpr int kShrink = 4;

}  // namespace

void forEachKeyframe(const SurfelMap& map, const PinholeCamera& camera,
                     const std::vector<Keyframe>& keyframes,
                     const std::function<void(const SeenPoints&)>& visit) {
  const PinholeCamera small = camera.withoutDistortion().shrunk(kShrink);
  SurfelRenderer renderer;
  RenderOptions options;
  options.only_stable = true;
  options.age = SurfelAge::all;
  ModelView view;
  for (const Keyframe& keyframe : keyframes) {
    if (keyframe.fragment != kFirstFragment) continue;
    renderer.render(map, small, keyframe.T_map_camera, options, view);
    SeenPoints seen;
    seen.from = keyframe.T_map_camera.translation().cast<float>();
    for (int v = 0; v < view.depth_m.rows; ++v) {
      for (int u = 0; u < view.depth_m.cols; ++u) {
        const float z = view.depth_m.at<float>(v, u);
        if (z <= 0) continue;
        seen.points.push_back((keyframe.T_map_camera * small.unproject(u, v, z)).cast<float>());
      }
    }
    visit(seen);
  }
}

}  // namespace pf
