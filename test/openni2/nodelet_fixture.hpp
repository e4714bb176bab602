// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <nodelet/loader.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <std_srvs/SetBool.h>

#include "device_fixture.hpp"

namespace pf::openni2 {

using diagnostic_msgs::DiagnosticStatus;
using sensor_msgs::CameraInfo;
using sensor_msgs::Image;

/// Keeps what comes on a topic.
template <typename Message>
class TopicKeeper {
 public:
  using Pointer = typename Message::ConstPtr;

  TopicKeeper(ros::NodeHandle& nh, const std::string& topic)
      : subscriber_(nh.subscribe<Message>(topic, 100, &TopicKeeper::keep, this)) {}
  ~TopicKeeper() { subscriber_.shutdown(); }

  std::vector<Pointer> all() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return messages_;
  }
  std::size_t size() const { return all().size(); }
  void clear() {
    const std::lock_guard<std::mutex> lock(mutex_);
    messages_.clear();
  }
  bool waitFor(std::size_t n) const {
    return eventually([&] { return size() >= n; });
  }

 private:
  void keep(const Pointer& message) {
    const std::lock_guard<std::mutex> lock(mutex_);
    messages_.push_back(message);
  }

  mutable std::mutex mutex_;
  std::vector<Pointer> messages_;
  ros::Subscriber subscriber_;
};

/// Loads the driver into this process, as a manager does, with the virtual camera.
class DriverNodelet : public DeviceTest {
 protected:
  void SetUp() override {
    DeviceTest::SetUp();
    char name[] = "/tmp/posefusion_nodelet_XXXXXX";
    folder_ = mkdtemp(name);
    ros::param::del(kName);
    set("rgb_camera_info_url", "file://" + (folder_ / "rgb.yaml").string());
    set("depth_camera_info_url", "file://" + (folder_ / "depth.yaml").string());
    set("record_folder", folder_.string());
    set("reconnect_period_s", 0.2);
  }
  void TearDown() override {
    unload();
    std::filesystem::remove_all(folder_);
    DeviceTest::TearDown();
  }

  template <typename Value>
  void set(const std::string& parameter, const Value& value) {
    ros::param::set(std::string(kName) + "/" + parameter, value);
  }
  void load() { ASSERT_TRUE(loader_.load(kName, "posefusion/openni2_driver", {}, {})); }
  /// A thread that is still in a callback of the driver destroys it, a moment after this began.
  void unload() {
    loader_.unload(kName);
    EXPECT_TRUE(eventually([] { return virtualDevice().opened == virtualDevice().closed; }));
  }

  bool streams(std::size_t n) {
    color_.clear();
    depth_.clear();
    return color_.waitFor(n) && depth_.waitFor(n);
  }
  std_srvs::SetBool::Response record(bool on) {
    std_srvs::SetBool call;
    call.request.data = on;
    EXPECT_TRUE(ros::service::call(std::string(kName) + "/record", call));
    return call.response;
  }

  /// Whether the last diagnostics have this text and level within ten seconds.
  testing::AssertionResult diagnosed(int level, const std::string& text) {
    std::string last = "nothing";
    const bool found = eventually([&] {
      const auto messages = diagnostics_.all();
      if (messages.empty() || messages.back()->status.empty()) return false;
      const auto& status = messages.back()->status[0];
      last = std::to_string(status.level) + " " + status.message;
      return status.level == level && status.message.find(text) != std::string::npos;
    });
    if (found) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "the last diagnostics are: " << last;
  }
  std::string diagnosticValue(const std::string& key) {
    for (const auto& value : diagnostics_.all().back()->status[0].values) {
      if (value.key == key) return value.value;
    }
    return "(no such value)";
  }

  static constexpr const char* kName = "/camera/driver";

  std::filesystem::path folder_;
  ros::NodeHandle nh_{"camera"};
  nodelet::Loader loader_{false};
  TopicKeeper<diagnostic_msgs::DiagnosticArray> diagnostics_{nh_, "/diagnostics"};
  TopicKeeper<Image> color_{nh_, "rgb/image_raw"};
  TopicKeeper<CameraInfo> color_info_{nh_, "rgb/camera_info"};
  TopicKeeper<Image> depth_{nh_, "depth_registered/image_raw"};
  TopicKeeper<CameraInfo> depth_info_{nh_, "depth_registered/camera_info"};
};

/// The index of the frame of the virtual camera that an image shows; -1 for none.
inline int servedIndex(const Image& image, int to) {
  const auto kind = image.encoding == "rgb8" ? StreamKind::color : StreamKind::depth;
  KeptFrame frame;
  frame.width = static_cast<int>(image.width);
  frame.height = static_cast<int>(image.height);
  for (int index = 1; index <= to; ++index) {
    if (image.data == servedPixels(kind, frame, index)) return index;
  }
  return -1;
}

}  // namespace pf::openni2
