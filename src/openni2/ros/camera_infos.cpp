// SPDX-License-Identifier: BSD-3-Clause
#include "camera_infos.hpp"

#include <ros/console.h>
#include <sensor_msgs/distortion_models.h>

#include <cctype>
#include <cmath>

namespace pf::openni2 {

sensor_msgs::CameraInfo infoFromFieldOfView(const StreamInfo& stream) {
  const double width = stream.mode.width, height = stream.mode.height;
  const double fx = width / 2 / std::tan(stream.horizontal_fov_rad / 2);
  const double fy = height / 2 / std::tan(stream.vertical_fov_rad / 2);
  const double cx = (width - 1) / 2, cy = (height - 1) / 2;
  sensor_msgs::CameraInfo info;
  info.width = static_cast<std::uint32_t>(stream.mode.width);
  info.height = static_cast<std::uint32_t>(stream.mode.height);
  info.distortion_model = sensor_msgs::distortion_models::PLUMB_BOB;
  info.D.assign(5, 0.0);
  info.K = {fx, 0, cx, 0, fy, cy, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0};
  return info;
}

sensor_msgs::CameraInfo scaledInfo(sensor_msgs::CameraInfo info, int width) {
  const double scale = static_cast<double>(width) / info.width;
  // Pixel centres lie at whole numbers: the corner of the image is at -1/2.
  const auto centre = [scale](double c) { return (c + 0.5) * scale - 0.5; };
  for (auto* row : {&info.K[0], &info.K[3], &info.P[0], &info.P[4]}) {
    row[0] *= scale;
    row[1] *= scale;
    row[2] = centre(row[2]);
  }
  info.P[3] *= scale;
  info.P[7] *= scale;
  info.height = static_cast<std::uint32_t>(std::lround(info.height * scale));
  info.width = static_cast<std::uint32_t>(width);
  return info;
}

CameraInfos::CameraInfos(const ros::NodeHandle& nh, const std::string& url)
    : manager_(nh, "camera", url) {}

void CameraInfos::use(const std::string& name, const StreamInfo& imager) {
  std::string allowed = name;
  for (char& c : allowed) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  manager_.setCameraName(allowed);
  manager_.isCalibrated();  // reads the file now, not in the first frame's callback
  const std::lock_guard<std::mutex> lock(mutex_);
  name_ = allowed;
  imager_ = imager;
  warned_.clear();
}

sensor_msgs::CameraInfo CameraInfos::of(int width, int height) {
  sensor_msgs::CameraInfo info = manager_.getCameraInfo();
  const int w = static_cast<int>(info.width), h = static_cast<int>(info.height);
  if (info.K[0] == 0.0) return fallback(width, height, "the camera is not calibrated");
  if (w == width && h == height) return info;
  if (w * height == h * width) return scaledInfo(info, width);
  return fallback(
      width, height,
      "the calibration is for images of " + std::to_string(w) + "x" + std::to_string(h));
}

sensor_msgs::CameraInfo CameraInfos::fallback(int width, int height, const std::string& why) {
  const std::lock_guard<std::mutex> lock(mutex_);
  sensor_msgs::CameraInfo info = infoFromFieldOfView(imager_);
  if (width * imager_.mode.height == height * imager_.mode.width) {
    info = scaledInfo(info, width);
  } else {
    // Another shape: the sensor's full width, cut above and below.
    StreamInfo cut = imager_;
    cut.mode.width = width;
    cut.mode.height = height;
    cut.vertical_fov_rad = 2 * std::atan(std::tan(imager_.horizontal_fov_rad / 2) * height / width);
    info = infoFromFieldOfView(cut);
  }
  if (warned_.insert({width, height}).second) {
    ROS_WARN(
        "%s: %s, so camera_info of %dx%d is made from the field of view (focal length %.1f "
        "pixels, no distortion). Calibrate the camera for accurate maps.",
        name_.c_str(), why.c_str(), width, height, info.K[0]);
  }
  return info;
}

}  // namespace pf::openni2
