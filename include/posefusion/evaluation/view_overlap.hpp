// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/core/frame.hpp"
#include "posefusion/map/render.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// How much of what a frame sees is in a map: the share of the pixels with depth (up to the range
/// of the map's sensor) where
/// the map, drawn from the frame's true pose, has a stable surface at the same depth, within 5 cm
/// and three standard deviations of its noise.
class ViewOverlap {
 public:
  /// The map must outlive it. Its active surfels do not matter: all are drawn.
  explicit ViewOverlap(const SurfelMap& map) : map_(map) {}

  /// An undistorted frame. 0 where nothing has depth.
  double of(const RgbdFrame& frame, const Eigen::Isometry3d& T_map_camera);

 private:
  const SurfelMap& map_;
  SurfelRenderer renderer_;
  ModelView view_;
  cv::Mat depth_m_, small_m_;
};

}  // namespace pf
