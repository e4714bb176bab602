// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/camera_topics.hpp"

namespace posefusion_ros {

using sensor_msgs::CameraInfo;
using sensor_msgs::CameraInfoConstPtr;

void CameraTopics::subscribe(ros::NodeHandle& handle, const InputSettings& input,
                             InputPairing& pairing) {
  const int queue = input.pairing.queue_size;
  // Before the first frame comes.
  origin_ = " (colour " + handle.resolveName(input.color_topic) + ", depth " +
            handle.resolveName(input.depth_topic) + ", camera_info " +
            handle.resolveName(input.camera_info_topic) + ")";
  color_ = ImageSubscriber(handle, {input.color_topic, input.image_transport, queue, 0.0},
                           [&pairing](const InputImage& image) { pairing.addColor(image); });
  depth_ = ImageSubscriber(
      handle, {input.depth_topic, input.depthTransport(), queue, input.depth_stamp_offset_s},
      [&pairing](const InputImage& image) { pairing.addDepth(image); });
  info_ = handle.subscribe<CameraInfo>(
      input.camera_info_topic, static_cast<std::uint32_t>(queue),
      [&pairing](const CameraInfoConstPtr& info) { pairing.addInfo(info); });
  depth_info_ = handle.subscribe<CameraInfo>(
      input.depth_camera_info_topic, static_cast<std::uint32_t>(queue),
      [&pairing](const CameraInfoConstPtr& info) { pairing.addDepthInfo(info); });
}

}  // namespace posefusion_ros
