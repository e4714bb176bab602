// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rosbag/bag.h>
#include <sensor_msgs/CameraInfo.h>

#include "posefusion_ros/bags/bag_source.hpp"
#include "posefusion_ros/bags/input_image.hpp"

namespace posefusion_ros {

/// The cameras of colour and depth in a bag: their first camera_info; that of colour from
/// `camera_file` where it is not empty. Throws InputError naming the topic or the file when there
/// is none of colour.
InputCamera recordedCamera(rosbag::Bag& bag, const BagTopics& topics,
                           const std::string& camera_file);

/// The image in a message; nothing when it is none. `offset_s` is that of InputImage.
std::optional<InputImage> readImage(const rosbag::MessageInstance& message, double offset_s);

}  // namespace posefusion_ros
