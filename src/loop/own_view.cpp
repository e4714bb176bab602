// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/own_view.hpp"

#include "posefusion/core/static_odds.hpp"
#include "posefusion/loop/verify.hpp"

namespace pf {

void ownView(const FrameLevel& level, ModelView& view) {
  view.camera = level.camera;
  level.depth_m.copyTo(view.depth_m);
  view.depth_m.setTo(0, level.normal_z >= 0);
  view.normal_x = level.normal_x;
  view.normal_y = level.normal_y;
  view.normal_z = level.normal_z;
  view.intensity = level.intensity;
  view.odds.create(level.depth_m.size(), CV_32FC1);
  view.odds.setTo(static_odds::kMost);
}

bool canBePlaced(const WorkingFrame& frame, const TrackingConfig& config) {
  ModelView view;
  ownView(frame.levels[0], view);
  ModelPyramid points;
  points.assign(view, frame.sensor);
  return isKnown(track(frame, points, freeStart(Eigen::Isometry3d::Identity()), config));
}

}  // namespace pf
