// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/message_traits.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <optional>
#include <variant>

#include "posefusion/calibration/color_camera.hpp"
#include "posefusion/core/frame.hpp"

namespace posefusion_ros {

/// A colour or depth image of a camera or a bag, compressed or not; its pixels are decoded when
/// they are asked for.
struct InputImage {
  InputImage() = default;
  /// `offset_s` is added to the stamp that images are paired by.
  explicit InputImage(const sensor_msgs::ImageConstPtr& image, double offset_s = 0.0);
  explicit InputImage(const sensor_msgs::CompressedImageConstPtr& image, double offset_s = 0.0);

  /// The message where it is not compressed, else null.
  sensor_msgs::ImageConstPtr raw() const;

  std_msgs::Header header;
  std::int64_t stamp_ns = 0;  ///< to pair by: of the header, with the offset
  std::variant<sensor_msgs::ImageConstPtr, sensor_msgs::CompressedImageConstPtr> message;
};

/// As those of messages (conversions.hpp).
cv::Mat toColor(const InputImage& image);
cv::Mat toDepth(const InputImage& image);

/// What is known of the camera of a frame.
struct InputCamera {
  pf::PinholeCamera color;
  /// Of depth; it is looked at where the images differ in size. May be null.
  sensor_msgs::CameraInfoConstPtr depth_info;
  bool rectified = false;      ///< see toCamera()
  double depth_unit_m = 1e-3;  ///< of 16-bit depth
  /// What takes colour that is not registered to depth.
  std::optional<pf::ColorCamera> beside{};
};

/// A frame with one size, whose pixels are those of the messages wherever encodings and sizes
/// allow: the messages must live as long as it. Stamp of the colour. Throws InputError saying why
/// there is none.
pf::RgbdFrame toFrame(const InputImage& color, const InputImage& depth, const InputCamera& camera);

}  // namespace posefusion_ros

namespace ros::message_traits {

/// For message_filters.
template <>
struct TimeStamp<posefusion_ros::InputImage> {
  static ros::Time value(const posefusion_ros::InputImage& image) {
    return ros::Time().fromNSec(static_cast<std::uint64_t>(image.stamp_ns));
  }
};

}  // namespace ros::message_traits
