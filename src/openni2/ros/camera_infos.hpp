// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <camera_info_manager/camera_info_manager.h>
#include <sensor_msgs/CameraInfo.h>

#include <mutex>
#include <set>
#include <string>
#include <utility>

#include "posefusion_openni2/device.hpp"

namespace pf::openni2 {

/// Intrinsics of a camera without distortion, from its field of view.
sensor_msgs::CameraInfo infoFromFieldOfView(const StreamInfo& stream);

/// The same camera with images of another size of the same shape.
sensor_msgs::CameraInfo scaledInfo(sensor_msgs::CameraInfo info, int width);

/// The intrinsics of one imager: its calibration where there is one (camera_info_manager, service
/// set_camera_info), its field of view where there is none. Any thread.
class CameraInfos {
 public:
  CameraInfos(const ros::NodeHandle& nh, const std::string& url);

  /// A device was opened: `name` is that of its calibration.
  void use(const std::string& name, const StreamInfo& imager);
  /// For images of this size; stamp and frame are empty. Says once for each size where the numbers
  /// come from when it is not from a calibration of that size.
  sensor_msgs::CameraInfo of(int width, int height);

 private:
  sensor_msgs::CameraInfo fallback(int width, int height, const std::string& why);

  camera_info_manager::CameraInfoManager manager_;
  std::mutex mutex_;
  std::string name_;
  StreamInfo imager_;
  std::set<std::pair<int, int>> warned_;
};

}  // namespace pf::openni2
