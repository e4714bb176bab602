// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/bags/input_image.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/error.hpp"
#include "posefusion/core/one_size.hpp"
#include "posefusion_ros/bags/conversions.hpp"

namespace posefusion_ros {
namespace {

/// Never 0 or before it, nor after the last that ros::Time can say.
std::int64_t moved(const ros::Time& stamp, double offset_s) {
  if (offset_s == 0.0) return toNs(stamp);
  const auto offset_ns = static_cast<std::int64_t>(std::llround(offset_s * 1e9));
  return std::clamp<std::int64_t>(toNs(stamp) + offset_ns, 1, toNs(ros::TIME_MAX));
}

pf::PinholeCamera depthCamera(const InputCamera& camera) {
  try {
    return toCamera(*camera.depth_info, camera.rectified);
  } catch (const pf::InputError& error) {
    throw pf::InputError(std::string("of depth: ") + error.what());
  }
}

}  // namespace

InputImage::InputImage(const sensor_msgs::ImageConstPtr& image, double offset_s)
    : header(image->header), stamp_ns(moved(header.stamp, offset_s)), message(image) {}

InputImage::InputImage(const sensor_msgs::CompressedImageConstPtr& image, double offset_s)
    : header(image->header), stamp_ns(moved(header.stamp, offset_s)), message(image) {}

sensor_msgs::ImageConstPtr InputImage::raw() const {
  const auto* image = std::get_if<sensor_msgs::ImageConstPtr>(&message);
  return image != nullptr ? *image : sensor_msgs::ImageConstPtr();
}

cv::Mat toColor(const InputImage& image) {
  return std::visit([](const auto& message) { return toColor(message); }, image.message);
}

cv::Mat toDepth(const InputImage& image) {
  return std::visit([](const auto& message) { return toDepth(message); }, image.message);
}

pf::RgbdFrame toFrame(const InputImage& color, const InputImage& depth, const InputCamera& camera) {
  pf::RgbdFrame frame;
  frame.stamp_ns = toNs(color.header.stamp);
  frame.color = toColor(color);
  frame.depth = toDepth(depth);
  frame.depth_unit_m = camera.depth_unit_m;
  frame.camera = camera.color;
  const bool differ =
      !frame.color.empty() && !frame.depth.empty() && frame.color.size() != frame.depth.size();
  if (differ && camera.depth_info) {
    frame = pf::bringToOneSize(frame, depthCamera(camera));
  }
  const std::string defect = pf::defectOf(frame);
  if (defect.empty()) return frame;
  throw pf::InputError(differ ? defect + ", or a camera_info of depth" : defect);
}

}  // namespace posefusion_ros
