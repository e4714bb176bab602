// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <string>

#include "posefusion_openni2/settings.hpp"

namespace pf::openni2 {

/// Parameters of the driver that are fixed while it runs (private names; see docs/driver.md).
struct DriverSettings {
  DeviceSettings device;
  std::string rgb_frame_id = "camera_rgb_optical_frame";
  std::string depth_frame_id = "camera_depth_optical_frame";
  std::string rgb_camera_info_url;    ///< empty: camera_info_manager's default place
  std::string depth_camera_info_url;  ///< empty: camera_info_manager's default place
  double reconnect_period_s = 1.0;
  double stall_timeout_s = 3.0;     ///< a camera silent for so long is opened again
  std::string record_folder = ".";  ///< of ~record's files; the manager's folder is ~/.ros
};

/// Reads them. Warns of parameters that the driver does not have. Throws InputError that names the
/// parameter, its value and what was expected.
DriverSettings readDriverSettings(const ros::NodeHandle& private_nh);

}  // namespace pf::openni2
