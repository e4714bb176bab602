// SPDX-License-Identifier: BSD-3-Clause
// The chain, fed by a packer through an unpacker.
#include <gtest/gtest.h>

#include "diagnostics_listener.hpp"

namespace posefusion_ros {
namespace {

/// What a packer sends of the frames of a camera.
class Sender {
 public:
  explicit Sender(const std::string& space) : space_("/" + space), handle_(space_) {
    color_ = handle_.advertise<sensor_msgs::Image>(topics::kColor, 100);
    depth_ = handle_.advertise<sensor_msgs::Image>(topics::kDepth, 100);
    info_ = handle_.advertise<sensor_msgs::CameraInfo>(topics::kCameraInfo, 100);
    frames_ = handle_.subscribe<CompressedFrameMsg>(
        topics::kCompressedFrame, 100,
        boost::function<void(const CompressedFrameMsg::ConstPtr&)>(
            [this](const CompressedFrameMsg::ConstPtr& frame) {
              const std::lock_guard<std::mutex> lock(mutex_);
              heard_.push_back(frame);
            }));
  }
  template <typename Value>
  void set(const std::string& name, const Value& value) {
    ros::param::set(space_ + "/packer/" + name, value);
  }
  bool load() {
    return loader_.load(space_ + "/packer", "posefusion/packer", {}, {}) && Chain::waitUntil([&] {
             return color_.getNumSubscribers() > 0 && frames_.getNumPublishers() > 0;
           });
  }
  void send(const CameraMessages& m) {
    if (m.info) info_.publish(sensor_msgs::CameraInfoConstPtr(m.info));
    if (m.depth) depth_.publish(sensor_msgs::ImageConstPtr(m.depth));
    if (m.color) color_.publish(sensor_msgs::ImageConstPtr(m.color));
  }
  std::vector<CompressedFrameMsg::ConstPtr> heard() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return heard_;
  }
  bool waitFor(std::size_t count) const {
    return Chain::waitUntil([&] { return heard().size() >= count; });
  }

 private:
  std::string space_;
  ros::NodeHandle handle_;
  mutable std::mutex mutex_;
  std::vector<CompressedFrameMsg::ConstPtr> heard_;
  ros::Publisher color_, depth_, info_;
  ros::Subscriber frames_;
  nodelet::Loader loader_{false};
};

CameraMessages room(int i) { return toMessages(emptyRoom().frame(i).frame); }

/// A chain whose camera is an unpacker of `topic`.
bool loadWithUnpacker(Chain& chain, const std::string& topic) {
  ros::param::set(chain.space() + "/unpacker/frame_topic", topic);
  return chain.load() && chain.load({"unpacker"});
}

TEST(ChainMachines, FramesGoFromTheCameraThroughBothIntoTheMap) {
  Chain chain("station");
  Sender sender("walker");
  sender.set("rate_hz", 30.0);
  ASSERT_TRUE(sender.load());
  ASSERT_TRUE(loadWithUnpacker(chain, "/walker/compressed_frame"));
  ros::WallDuration(0.3).sleep();  // until the two are connected
  for (int i = 0; i < 10; ++i) {
    sender.send(room(i));
    ASSERT_TRUE(sender.waitFor(static_cast<std::size_t>(i + 1)));
    ASSERT_TRUE(chain.waitForStatuses(static_cast<std::size_t>(i + 1)));
    const auto status = chain.statuses().back();
    EXPECT_EQ(outcome(status), TrackingStatusMsg::FUSED) << status.reason;
    EXPECT_EQ(toNs(status.header.stamp), emptyRoom().stamp(i));
  }
}

TEST(ChainMachines, ThePackerKeepsItsRateAndNamesWhatDoesNotFit) {
  Sender sender("slow_walker");
  Chain names("slow_walker");
  sender.set("diagnostic_period", 0.05);
  sender.set("queue_size", 100);
  Diagnostics diagnostics(names);
  ASSERT_TRUE(sender.load());
  for (int i = 0; i < 31; ++i) sender.send(room(i));  // a second of 30 Hz
  ASSERT_TRUE(diagnostics.waitFor("packer", "given up: paused", "15"));
  ASSERT_TRUE(sender.waitFor(16));  // the count may be here before the last of them
  EXPECT_EQ(sender.heard().size(), 16U);
  auto wrong = room(32);
  wrong.color->encoding = "cmyk8";
  sender.send(wrong);
  ASSERT_TRUE(diagnostics.waitFor("packer", "given up: bad_input", "1"));
  wrong = room(34);
  wrong.info->width = 17;
  sender.send(wrong);
  ASSERT_TRUE(diagnostics.waitFor("packer", "given up: bad_input", "2"));
  sender.send(room(36));
  ASSERT_TRUE(sender.waitFor(17));
  EXPECT_EQ(toNs(sender.heard().back()->header.stamp), emptyRoom().stamp(36));
}

TEST(ChainMachines, DamagedMessagesAreCountedAndTheNextOnesFused) {
  Sender sender("damaged_walker");
  sender.set("rate_hz", 30.0);
  ASSERT_TRUE(sender.load());
  for (int i = 0; i < 8; ++i) sender.send(room(i));
  ASSERT_TRUE(sender.waitFor(8));
  Chain chain("damaged_station");
  Diagnostics diagnostics(chain);
  ros::param::set(chain.space() + "/unpacker/diagnostic_period", 0.05);
  auto link = chain.handle().advertise<CompressedFrameMsg>("/damaged_link", 10);
  ASSERT_TRUE(loadWithUnpacker(chain, "/damaged_link"));
  ASSERT_TRUE(Chain::waitUntil([&] { return link.getNumSubscribers() > 0; }));
  const std::vector<std::pair<std::string, std::function<void(CompressedFrameMsg&)>>> damages = {
      {"", [](auto&) {}},
      {"colour image is not whole", [](auto& m) { m.color.data.resize(m.color.data.size() / 2); }},
      {"depth image is not a whole", [](auto& m) { m.depth.data.resize(m.depth.data.size() / 2); }},
      {"colour comes with an empty camera_info",
       [](auto& m) { m.camera_info = sensor_msgs::CameraInfo(); }},
      {"of different frames", [](auto& m) { m.depth.header.stamp += ros::Duration(0.1); }},
      {"the stamp jumps", [](auto& m) { m.header.stamp += ros::Duration(1000); }},
      {"", [](auto&) {}},
      {"the stamp went back", [](auto& m) { m.header.stamp -= ros::Duration(0.5); }}};
  for (std::size_t i = 0; i < damages.size(); ++i) {
    auto message = boost::make_shared<CompressedFrameMsg>(*sender.heard()[i]);
    damages[i].second(*message);
    link.publish(CompressedFrameMsg::ConstPtr(message));
    ASSERT_TRUE(chain.waitForStatuses(i + 1));
    const auto status = chain.statuses().back();
    const bool good = damages[i].first.empty();
    EXPECT_EQ(outcome(status), good ? TrackingStatusMsg::FUSED : TrackingStatusMsg::BAD_INPUT)
        << i << status.reason;
    if (good) continue;
    EXPECT_NE(status.reason.find("/damaged_link: "), std::string::npos) << status.reason;
    EXPECT_NE(status.reason.find(damages[i].first), std::string::npos) << status.reason;
  }
  EXPECT_TRUE(diagnostics.waitFor("unpacker", "given up: bad_input", "6"));
}

}  // namespace
}  // namespace posefusion_ros
