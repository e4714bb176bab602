// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/view_overlap.hpp"

#include <algorithm>
#include <cmath>

#include "depth_tolerance.hpp"
#include "posefusion/frame/depth_filter.hpp"

namespace pf {
namespace {

constexpr int kShrink = 4;  // a share needs no more

}  // namespace

double ViewOverlap::of(const RgbdFrame& frame, const Eigen::Isometry3d& T_map_camera) {
  const DepthSensor& sensor = map_.sensor();
  depthInMetres(frame, 0.0, sensor.max_depth_m, depth_m_);
  shrinkDepth(depth_m_, kShrink, sensor, small_m_);
  RenderOptions options;
  options.only_stable = true;
  options.age = SurfelAge::all;
  renderer_.render(map_, frame.camera.shrunk(kShrink), T_map_camera, options, view_);
  int valid = 0, known = 0;
  for (int v = 0; v < small_m_.rows; ++v) {
    for (int u = 0; u < small_m_.cols; ++u) {
      const float seen = small_m_.at<float>(v, u), mapped = view_.depth_m.at<float>(v, u);
      if (seen <= 0) continue;
      ++valid;
      const float tolerance = depthTolerance(sensor, seen);
      known += mapped > 0 && std::abs(seen - mapped) < tolerance ? 1 : 0;
    }
  }
  return static_cast<double>(known) / std::max(1, valid);
}

}  // namespace pf
