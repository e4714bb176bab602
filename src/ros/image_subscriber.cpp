// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/image_subscriber.hpp"

namespace posefusion_ros {
namespace {

template <typename Message>
ros::Subscriber subscribeTo(ros::NodeHandle& handle, const std::string& topic,
                            const ImageSubscriber::Source& source,
                            const ImageSubscriber::Handler& handler) {
  using Pointer = boost::shared_ptr<const Message>;
  const double offset_s = source.offset_s;
  const boost::function<void(const Pointer&)> take = [handler, offset_s](const Pointer& message) {
    handler(InputImage(message, offset_s));
  };
  return handle.subscribe<Message>(topic, static_cast<std::uint32_t>(source.queue_size), take);
}

}  // namespace

ImageSubscriber::ImageSubscriber(ros::NodeHandle& handle, const Source& source,
                                 const Handler& handler)
    : transport_(source.transport) {
  // As image_transport does it: the raw name is remapped, the transport comes below it.
  const std::string topic = handle.resolveName(source.topic);
  subscriber_ = transport_ == "raw"
                    ? subscribeTo<sensor_msgs::Image>(handle, topic, source, handler)
                    : subscribeTo<sensor_msgs::CompressedImage>(handle, topic + "/" + transport_,
                                                                source, handler);
}

std::string ImageSubscriber::type() const {
  return transport_ == "raw" ? "sensor_msgs/Image" : "sensor_msgs/CompressedImage";
}

std::string ImageSubscriber::advice() const {
  if (transport_ == "raw") return {};
  const std::string plugin = transport_ == "compressed" ? "compressed-image-transport"
                                                        : "compressed-depth-image-transport";
  return "; the publisher of the images offers it with the package ros-noetic-" + plugin +
         " (Debian 12 has none): without, image_transport is to be raw";
}

}  // namespace posefusion_ros
