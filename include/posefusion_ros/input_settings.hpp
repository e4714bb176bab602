// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/slam/config.hpp"
#include "posefusion_ros/input_pairing.hpp"
#include "posefusion_ros/parameters.hpp"

namespace posefusion_ros {

/// How the images of a camera come: what its driver calls them, and what is said about them.
struct InputSettings {
  std::string camera_name;  ///< namespace of the topics that do not begin with "/"
  std::string color_topic, depth_topic, camera_info_topic, depth_camera_info_topic;
  std::string image_transport = "raw";
  std::string depth_image_transport = "auto";
  std::string input_rectified = "auto";
  bool require_same_frame = true;
  double depth_unit_m = 1e-3;
  double depth_stamp_offset_s = 0.0;
  PairingSettings pairing;

  /// raw, compressed or compressedDepth.
  std::string depthTransport() const;
};

void visitFields(InputSettings& settings, pf::FieldVisitor& visitor);

/// A file of config/cameras: how the images come (`input`), and settings of the chain (`settings`,
/// groups as in config/posefusion.yaml).
struct CameraSettings {
  InputSettings input;
  YAML::Node settings;
};

/// Throws InputError naming file, key, value and what was expected, unknown keys too.
CameraSettings loadCameraSettings(const std::string& path);

/// From the parameters of a nodelet: the file that `camera_settings` names, then parameters of the
/// same names, of which empty ones do not count. `camera_name` is for the topics that the file
/// names; without a file, and where it names none, they are those of names.hpp.
InputSettings readInput(Parameters& parameters);

}  // namespace posefusion_ros
