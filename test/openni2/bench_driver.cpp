// SPDX-License-Identifier: BSD-3-Clause
// How long a frame takes from the camera's driver, through the OpenNI2 library, to the published
// pointer. Needs a master: roslaunch test/openni2/bench_driver.launch
#include <ros/ros.h>

#include <algorithm>
#include <cstdio>

#include "device_fixture.hpp"
#include "openni2/ros/stream_publisher.hpp"

namespace pf::openni2 {
namespace {

constexpr std::size_t kFrames = 300;
constexpr double kLimit_ms = 1.0;

/// Publishes frames and notes how long that took.
class TimedPublisher {
 public:
  TimedPublisher(const ros::NodeHandle& nh, const char* topic, int stream)
      : infos_(std::make_shared<CameraInfos>(ros::NodeHandle(nh, topic), "")),
        publisher_(nh, {topic, "camera_rgb_optical_frame"}, infos_),
        raised_ns_(virtualDevice().raised_ns[static_cast<std::size_t>(stream)]) {}

  void publish(const SensorFrame& frame) {
    const std::int64_t raised = raised_ns_;
    publisher_.publish(frame, clock_);
    const std::int64_t now =
        std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
    if (count_ < kFrames) taken_ms_[count_++] = 1e-6 * static_cast<double>(now - raised);
  }
  void use(const Device& device, StreamKind kind) { infos_->use("bench", device.stream(kind)); }
  bool done() const { return count_ == kFrames; }
  double report(const char* name) {
    std::sort(taken_ms_.begin(), taken_ms_.end());
    const double median = taken_ms_[kFrames / 2];
    std::printf("%s: driver to published pointer: median %.3f ms, 95%% below %.3f ms, %zu frames\n",
                name, median, taken_ms_[kFrames * 95 / 100], kFrames);
    return median;
  }

 private:
  const std::shared_ptr<CameraInfos> infos_;
  StreamPublisher publisher_;
  const std::atomic<std::int64_t>& raised_ns_;
  ClockMap clock_{ClockMap::Source::live};
  std::atomic<std::size_t> count_{0};
  std::array<double, kFrames> taken_ms_{};
};

void discard(const sensor_msgs::ImageConstPtr&) {}

int run() {
  ros::NodeHandle nh("camera");
  TimedPublisher color(nh, "rgb", 0), depth(nh, "depth_registered", 1);
  const auto color_reader = nh.subscribe("rgb/image_raw", 2, discard);
  const auto depth_reader = nh.subscribe("depth_registered/image_raw", 2, discard);
  ros::AsyncSpinner spinner(1);
  spinner.start();
  {
    Device device{DeviceSettings{}};
    color.use(device, StreamKind::color);
    depth.use(device, StreamKind::depth);
    device.start([&](const SensorFrame& frame) {
      (frame.kind == StreamKind::color ? color : depth).publish(frame);
    });
    if (!eventually([&] { return color.done() && depth.done(); }, 60000)) return 1;
  }
  const double worst = std::max(color.report("colour 640x480"), depth.report("depth 640x480"));
  return worst <= kLimit_ms ? 0 : 1;
}

}  // namespace
}  // namespace pf::openni2

int main(int argc, char** argv) {
  ros::init(argc, argv, "bench_openni2_driver");
  return pf::openni2::run();
}
