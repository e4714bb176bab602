// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <image_transport/image_transport.h>
#include <sensor_msgs/Image.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "camera_infos.hpp"
#include "posefusion_openni2/clock_map.hpp"
#include "posefusion_openni2/frame.hpp"

namespace pf::openni2 {

/// The message of a frame: one copy of its pixels.
sensor_msgs::ImagePtr toImage(const SensorFrame& frame);

/// Publishes one stream as image_raw and camera_info, without further copies inside the manager.
/// publish() runs on the stream's thread, the rest on any.
class StreamPublisher {
 public:
  struct Frames {
    std::string topic;     ///< rgb, depth_registered or depth
    std::string frame_id;  ///< of image and camera_info
  };

  StreamPublisher(const ros::NodeHandle& nh, Frames frames, std::shared_ptr<CameraInfos> infos);

  void publish(const SensorFrame& frame, ClockMap& clock);
  void setTimeOffset(double seconds) { time_offset_s_ = seconds; }

  /// Milliseconds from the driver's callback to the published pointer: median of the last frames;
  /// 0 before the first.
  double medianLatencyMs() const;

 private:
  ros::Time stampOf(const SensorFrame& frame, ClockMap& clock);
  void noteLatency(const SensorFrame& frame);

  const Frames frames_;
  const std::shared_ptr<CameraInfos> infos_;
  image_transport::ImageTransport transport_;
  image_transport::CameraPublisher publisher_;
  std::atomic<double> time_offset_s_{0.0};
  ros::Time last_stamp_;
  mutable std::mutex latency_mutex_;
  std::vector<float> latency_ms_;
  std::size_t next_latency_ = 0;
};

}  // namespace pf::openni2
