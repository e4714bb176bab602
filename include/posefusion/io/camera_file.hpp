// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "posefusion/calibration/color_camera.hpp"
#include "posefusion/core/camera.hpp"

namespace pf {

/// A camera as users keep it in a file.
struct CameraFile {
  PinholeCamera camera;
  std::optional<double> depth_factor;  ///< steps of a 16-bit depth in a metre: 1000, TUM 5000
  std::string sensor_kind{};           ///< one of sensorKinds(); empty: not known
  std::optional<ColorCamera> color{};  ///< of colour that is not registered to depth
};

/// Reads YAML with plain keys (`width height fx fy cx cy depth_factor`, `sensor` for what takes the
/// depth, `distortion_model` and its coefficients: `k1 k2 p1 p2 k3 [k4 k5 k6]`, or `k1 k2 k3 k4` of
/// `equidistant`; `color_fx color_fy color_cx color_cy color_depth_right_m` where colour is not
/// registered to depth), with those of ORB-SLAM (`Camera.fx`, `Camera.type`, `DepthMapFactor`), of
/// OpenCV or of ROS's camera_calibration (`image_width`, `camera_matrix`,
/// `distortion_coefficients`). Throws InputError naming the file and the key.
CameraFile loadCamera(const std::string& path);

/// Writes plain keys. Throws InputError naming the file.
void saveCamera(const std::string& path, const CameraFile& file);

}  // namespace pf
