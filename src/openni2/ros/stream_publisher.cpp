// SPDX-License-Identifier: BSD-3-Clause
#include "stream_publisher.hpp"

#include <sensor_msgs/image_encodings.h>

#include <algorithm>

namespace pf::openni2 {
namespace {

constexpr std::size_t kLatencies = 300;
constexpr std::uint32_t kQueue = 10;

}  // namespace

sensor_msgs::ImagePtr toImage(const SensorFrame& frame) {
  auto image = boost::make_shared<sensor_msgs::Image>();
  image->width = static_cast<std::uint32_t>(frame.width);
  image->height = static_cast<std::uint32_t>(frame.height);
  image->step = static_cast<std::uint32_t>(frame.row_bytes);
  image->is_bigendian = 0;
  image->encoding = frame.kind == StreamKind::color ? sensor_msgs::image_encodings::RGB8
                                                    : sensor_msgs::image_encodings::TYPE_16UC1;
  // Inserting writes each byte once; resizing first would write zeros before them.
  const auto rows = static_cast<std::ptrdiff_t>(frame.height);
  image->data.reserve(static_cast<std::size_t>(rows * frame.row_bytes));
  if (frame.stride_bytes == frame.row_bytes) {
    image->data.assign(frame.data, frame.data + rows * frame.row_bytes);
    return image;
  }
  for (std::ptrdiff_t y = 0; y < rows; ++y) {
    const std::uint8_t* row = frame.data + y * frame.stride_bytes;
    image->data.insert(image->data.end(), row, row + frame.row_bytes);
  }
  return image;
}

StreamPublisher::StreamPublisher(const ros::NodeHandle& nh, Frames frames,
                                 std::shared_ptr<CameraInfos> infos)
    : frames_(std::move(frames)),
      infos_(std::move(infos)),
      transport_(ros::NodeHandle(nh, frames_.topic)),
      publisher_(transport_.advertiseCamera("image_raw", kQueue)) {
  latency_ms_.reserve(kLatencies);
}

ros::Time StreamPublisher::stampOf(const SensorFrame& frame, ClockMap& clock) {
  const auto arrival_ns = static_cast<std::int64_t>(ros::Time::now().toNSec());
  const auto taken_ns = clock.toHostNs(frame.device_time_us, arrival_ns) +
                        static_cast<std::int64_t>(time_offset_s_ * 1e9);
  ros::Time stamp;
  stamp.fromNSec(static_cast<std::uint64_t>(std::max<std::int64_t>(taken_ns, 1)));
  // While the clock map settles it may correct itself by more than the time between two frames.
  const ros::Duration back = last_stamp_ - stamp;
  if (back.toSec() >= 0.0 && back.toSec() < 0.5) stamp = last_stamp_ + ros::Duration(0, 1000);
  last_stamp_ = stamp;
  return stamp;
}

void StreamPublisher::publish(const SensorFrame& frame, ClockMap& clock) {
  const ros::Time stamp = stampOf(frame, clock);
  if (publisher_.getNumSubscribers() == 0) return;
  const sensor_msgs::ImagePtr image = toImage(frame);
  image->header.stamp = stamp;
  image->header.frame_id = frames_.frame_id;
  const auto info =
      boost::make_shared<sensor_msgs::CameraInfo>(infos_->of(frame.width, frame.height));
  info->header = image->header;
  publisher_.publish(image, info);
  noteLatency(frame);
}

void StreamPublisher::noteLatency(const SensorFrame& frame) {
  const std::chrono::duration<float, std::milli> taken =
      std::chrono::steady_clock::now() - frame.arrival;
  const std::lock_guard<std::mutex> lock(latency_mutex_);
  if (latency_ms_.size() < kLatencies) {
    latency_ms_.push_back(taken.count());
  } else {
    latency_ms_[next_latency_] = taken.count();
  }
  next_latency_ = (next_latency_ + 1) % kLatencies;
}

double StreamPublisher::medianLatencyMs() const {
  std::vector<float> sorted;
  {
    const std::lock_guard<std::mutex> lock(latency_mutex_);
    sorted = latency_ms_;
  }
  if (sorted.empty()) return 0.0;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

}  // namespace pf::openni2
