// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <functional>
#include <string>

#include "posefusion_ros/bags/input_image.hpp"

namespace posefusion_ros {

/// Images of a topic through a transport of image_transport. Compressed ones are decoded by us
/// (input_image.hpp): Debian 12 has no package of the plugins, and none is needed on this side.
class ImageSubscriber {
 public:
  struct Source {
    std::string topic;      ///< raw name, remapped as always
    std::string transport;  ///< raw, compressed or compressedDepth
    int queue_size = 10;
    double offset_s = 0.0;  ///< see InputImage
  };
  using Handler = std::function<void(const InputImage&)>;

  ImageSubscriber() = default;
  /// `handler` is called in the queue of `handle`.
  ImageSubscriber(ros::NodeHandle& handle, const Source& source, const Handler& handler);

  /// What is subscribed to: with the transport.
  std::string topic() const { return subscriber_.getTopic(); }
  std::string type() const;
  bool hasPublisher() const { return subscriber_.getNumPublishers() > 0; }

  /// For the message that it has no publisher: the package that the publisher needs; empty for raw.
  std::string advice() const;

 private:
  std::string transport_ = "raw";
  ros::Subscriber subscriber_;
};

}  // namespace posefusion_ros
