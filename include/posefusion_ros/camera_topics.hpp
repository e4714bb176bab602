// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <string>

#include "posefusion_ros/image_subscriber.hpp"
#include "posefusion_ros/input_pairing.hpp"
#include "posefusion_ros/input_settings.hpp"

namespace posefusion_ros {

/// The topics of a camera: colour, depth, and the camera_info of both. What comes goes to a
/// pairing.
class CameraTopics {
 public:
  /// Once. Messages may come, in another thread, before it returns. `pairing` outlives this.
  void subscribe(ros::NodeHandle& handle, const InputSettings& input, InputPairing& pairing);

  /// The names of the topics in brackets, for messages about a frame; known before the first comes.
  const std::string& origin() const { return origin_; }
  const ImageSubscriber& color() const { return color_; }
  const ImageSubscriber& depth() const { return depth_; }
  const ros::Subscriber& info() const { return info_; }

 private:
  std::string origin_;
  ImageSubscriber color_, depth_;
  ros::Subscriber info_, depth_info_;
};

}  // namespace posefusion_ros
