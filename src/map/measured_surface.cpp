// SPDX-License-Identifier: BSD-3-Clause
#include "measured_surface.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "posefusion/frame/depth_filter.hpp"

namespace pf {
void MeasuredSurface::assign(const WorkingFrame& frame, int shrink) {
  frame_ = &frame;
  sensor_ = frame.sensor;
  const PinholeCamera& full = frame.full_camera;
  const int tracked = static_cast<int>(std::lround(full.fx / frame.camera.fx));
  spacing_rad_ = static_cast<float>(shrink / full.fx);
  levels_ = 1;
  while (levels_ < kMostLevels && (shrink << levels_) <= tracked) ++levels_;
  // The noise may be larger for its distance very near than far away.
  levels_ = 1 + std::max(levelOf(static_cast<float>(sensor_.min_depth_m)),
                         levelOf(static_cast<float>(sensor_.max_depth_m)));
  pixels_ = 0;
  for (int i = 0; i < levels_; ++i) setLevel(i, shrink << i, tracked);
}

/// `shrink`: of the level, against the frame; `tracked`: of the working frame.
void MeasuredSurface::setLevel(int index, int shrink, int tracked) {
  const auto i = static_cast<std::size_t>(index);
  const WorkingFrame& frame = *frame_;
  Level& level = level_[i];
  const PinholeCamera camera = frame.full_camera.shrunk(shrink);
  const cv::Size size(camera.width, camera.height);
  level.fx = static_cast<float>(camera.fx);
  level.fy = static_cast<float>(camera.fy);
  level.cx = static_cast<float>(camera.cx);
  level.cy = static_cast<float>(camera.cy);
  level.scale = static_cast<float>(tracked) / static_cast<float>(shrink);
  level.first = pixels_;
  pixels_ += static_cast<std::size_t>(size.area());
  if (shrink == tracked) {
    level.depth_m = frame.depth_m;
    level.color = frame.color;
    return;
  }
  if (shrink == 1) {
    level.depth_m = frame.full_depth_m;
    level.color = frame.full_color;
    return;
  }
  const bool from_finer = index > 0;
  shrinkDepth(from_finer ? level_[i - 1].depth_m : frame.full_depth_m, from_finer ? 2 : shrink,
              sensor_, own_depth_m_[i]);
  cv::resize(frame.full_color, own_color_[i], size, 0, 0, cv::INTER_AREA);
  level.depth_m = own_depth_m_[i];
  level.color = own_color_[i];
}

}  // namespace pf
