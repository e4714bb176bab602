// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>

#include "posefusion/core/camera.hpp"
#include "posefusion/core/map_pose.hpp"

namespace pf {

/// The map seen from a pose. All images have the camera's size; where depth is 0 nothing was hit.
struct ModelView {
  std::int64_t stamp_ns = 0;  ///< of the frame whose pose it is rendered from
  PinholeCamera camera;
  int fragment = kFirstFragment;  ///< of the map, that is seen
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  /// Corrections move the map, and the camera with it. From coordinates in which they move neither,
  /// to the map's: only the camera's own motion is in T_uncorrected_camera().
  Eigen::Isometry3d T_map_uncorrected = Eigen::Isometry3d::Identity();
  /// From the map's coordinates to the user's frame, as far as known.
  std::optional<Eigen::Isometry3d> T_world_map{};
  cv::Mat depth_m;    ///< CV_32FC1, along the optical axis, 0 = nothing
  cv::Mat normal_x;   ///< CV_32FC1, camera frame, unit length, towards the camera
  cv::Mat normal_y;   ///< CV_32FC1
  cv::Mat normal_z;   ///< CV_32FC1
  cv::Mat intensity;  ///< CV_32FC1, 0..255
  cv::Mat odds;       ///< CV_32FC1, that the surfel stands still (nats), see static_odds
  cv::Mat color;      ///< CV_8UC3 R G B; empty unless asked for
  cv::Mat stable;     ///< CV_8UC1, 1 = a stable surfel; empty: not known

  bool empty() const { return depth_m.empty(); }
  Eigen::Isometry3d T_uncorrected_camera() const {
    return T_map_uncorrected.inverse() * T_map_camera;
  }
};

}  // namespace pf
