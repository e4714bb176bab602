// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/core/camera.hpp"
#include "posefusion/core/depth_sensor.hpp"
#include "posefusion/core/map_pose.hpp"

namespace pf {

/// Measurements of a keyframe on the depth camera.
struct CalibrationView {
  int id = -1;           ///< of the keyframe; no two views have the same
  PinholeCamera camera;  ///< of the depth image, without lens distortion
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  int fragment = kFirstFragment;  ///< of the map, that the pose is in
  cv::Mat depth_mm;               ///< CV_16UC1, 0 = none; people are out of it
  DepthSensor sensor{};           ///< that took it
};

/// A piece of plane, fitted to a small window of a depth image. Planes are linear in inverse depth:
/// w(u, v) = w + by_u (u - u_patch) + by_v (v - v_patch), pixels of the view.
struct SurfacePatch {
  float u = 0, v = 0;        ///< centre of the window, pixels
  float w = 0;               ///< inverse depth there, as measured (1/m); 0: no patch
  float by_u = 0, by_v = 0;  ///< 1/m per pixel
  float sigma = 0;           ///< standard deviation of w (1/m), of the sensor's noise
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit (camera frame, towards the camera)
};

/// The smooth, not grazing surface in a view, as patches on a regular grid of about 80 columns,
/// whatever the size of the image.
class ViewSurface {
 public:
  explicit ViewSurface(const CalibrationView& view);

  int id() const { return id_; }
  const PinholeCamera& camera() const { return camera_; }
  const Eigen::Isometry3d& T_map_camera() const { return T_map_camera_; }
  int fragment() const { return fragment_; }
  const std::vector<SurfacePatch>& patches() const { return patches_; }  ///< those there are

  void setPose(const MapPose& pose) {
    T_map_camera_ = pose.T_map_camera;
    fragment_ = pose.fragment;
  }

  /// The patch nearest to a pixel; null where there is none.
  const SurfacePatch* near(double u, double v) const;

 private:
  int id_;
  PinholeCamera camera_;
  Eigen::Isometry3d T_map_camera_;
  int fragment_;
  int step_ = 1, radius_ = 1, columns_ = 0, rows_ = 0;
  std::vector<int> index_;  ///< of the patch of each cell; -1: none
  std::vector<SurfacePatch> patches_;
};

}  // namespace pf
