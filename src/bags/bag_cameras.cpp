// SPDX-License-Identifier: BSD-3-Clause
#include "bag_cameras.hpp"

#include <rosbag/view.h>

#include "posefusion/core/error.hpp"
#include "posefusion/io/camera_file.hpp"
#include "posefusion_ros/bags/conversions.hpp"

namespace posefusion_ros {
namespace {

using pf::InputError;

sensor_msgs::CameraInfoConstPtr firstInfo(rosbag::Bag& bag, const std::string& topic) {
  if (topic.empty()) return {};
  rosbag::View infos(bag, rosbag::TopicQuery(topic));
  if (infos.size() == 0) return {};
  return infos.begin()->instantiate<sensor_msgs::CameraInfo>();
}

pf::PinholeCamera colorCamera(rosbag::Bag& bag, const BagTopics& topics, bool rectified) {
  if (topics.camera_info.empty()) {
    throw InputError("there is no camera_info for " + topics.color +
                     ", expected a topic beside it, or a camera file (--camera)");
  }
  const auto info = firstInfo(bag, topics.camera_info);
  if (!info) throw InputError("topic " + topics.camera_info + " has no message");
  try {
    return toCamera(*info, rectified);
  } catch (const InputError& error) {
    throw InputError("topic " + topics.camera_info + ": " + error.what());
  }
}

}  // namespace

InputCamera recordedCamera(rosbag::Bag& bag, const BagTopics& topics,
                           const std::string& camera_file) {
  InputCamera camera;
  camera.rectified = topics.color.find("rect") != std::string::npos;
  if (camera_file.empty()) {
    camera.color = colorCamera(bag, topics, camera.rectified);
  } else {
    const pf::CameraFile file = pf::loadCamera(camera_file);
    camera.color = file.camera;
    camera.beside = file.color;
  }
  camera.depth_info = firstInfo(bag, topics.depth_camera_info);
  return camera;
}

std::optional<InputImage> readImage(const rosbag::MessageInstance& message, double offset_s) {
  if (const auto image = message.instantiate<sensor_msgs::Image>()) {
    return InputImage(sensor_msgs::ImageConstPtr(image), offset_s);
  }
  if (const auto image = message.instantiate<sensor_msgs::CompressedImage>()) {
    return InputImage(sensor_msgs::CompressedImageConstPtr(image), offset_s);
  }
  return std::nullopt;
}

}  // namespace posefusion_ros
