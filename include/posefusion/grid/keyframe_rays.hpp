// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/core/camera.hpp"
#include "posefusion/graph/keyframe.hpp"
#include "posefusion/map/render.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// Where a camera stood, and what of the map it saw from there (m, map frame).
struct SeenPoints {
  Eigen::Vector3f from = Eigen::Vector3f::Zero();
  std::vector<Eigen::Vector3f> points;
};

/// Draws what keyframes of the first fragment see of its stable surfels, one ray in 4 x 4 pixels,
/// as they are in the map now. People and what has moved are not in it.
class KeyframeRays {
 public:
  /// `camera`: of the keyframes.
  explicit KeyframeRays(const PinholeCamera& camera);

  /// Depth along the rays (CV_32FC1, m, 0: nothing), valid until the next call.
  const cv::Mat& draw(const SurfelMap& map, const Eigen::Isometry3d& T_map_camera);

  SeenPoints points(const cv::Mat& depth_m, const Eigen::Isometry3d& T_map_camera) const;

 private:
  PinholeCamera camera_;
  SurfelRenderer renderer_;
  ModelView view_;
};

/// Calls visit(seen) for each keyframe of the first fragment.
void forEachKeyframe(const SurfelMap& map, const PinholeCamera& camera,
                     const std::vector<Keyframe>& keyframes,
                     const std::function<void(const SeenPoints&)>& visit);

}  // namespace pf
