// SPDX-License-Identifier: BSD-3-Clause
// Images as other cameras send them.
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "chain_fixture.hpp"
#include "compressed_messages.hpp"
#include "posefusion_ros/image_subscriber.hpp"

namespace posefusion_ros {
namespace {

/// Pixels that the chain lets pass.
class SharpImages {
 public:
  explicit SharpImages(Chain& chain) {
    const boost::function<void(const sensor_msgs::ImageConstPtr&)> on_color =
        [this](const sensor_msgs::ImageConstPtr& image) { color = image; };
    const boost::function<void(const sensor_msgs::ImageConstPtr&)> on_depth =
        [this](const sensor_msgs::ImageConstPtr& image) { depth = image; };
    subscribers_ = {
        chain.handle().subscribe<sensor_msgs::Image>(topics::kSharpColor, 10, on_color),
        chain.handle().subscribe<sensor_msgs::Image>(topics::kSharpDepth, 10, on_depth)};
  }
  sensor_msgs::ImageConstPtr color, depth;

 private:
  std::vector<ros::Subscriber> subscribers_;
};

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(ChainCameras, ATransportIsBelowTheRawNameAndNamesThePackageOfTheSender) {
  ros::NodeHandle handle("transports");
  const auto ignore = [](const InputImage&) {};
  const ImageSubscriber raw(handle, {"eye/image", "raw"}, ignore);
  EXPECT_EQ(raw.topic(), "/transports/eye/image");
  EXPECT_EQ(raw.type(), "sensor_msgs/Image");
  EXPECT_EQ(raw.advice(), "");
  const ImageSubscriber depth(handle, {"/depth/image", "compressedDepth"}, ignore);
  EXPECT_EQ(depth.topic(), "/depth/image/compressedDepth");
  EXPECT_EQ(depth.type(), "sensor_msgs/CompressedImage");
  EXPECT_FALSE(depth.hasPublisher());
  EXPECT_NE(depth.advice().find("ros-noetic-compressed-depth-image-transport"), std::string::npos);
}

TEST(ChainCameras, CompressedImagesAreFusedAsTheRawOnesAre) {
  Chain chain("compressed");
  chain.set("image_transport", std::string("compressed"));
  ros::Publisher color = chain.handle().advertise<sensor_msgs::CompressedImage>(
      std::string(topics::kColor) + "/compressed", 10);
  ros::Publisher depth = chain.handle().advertise<sensor_msgs::CompressedImage>(
      std::string(topics::kDepth) + "/compressedDepth", 10);
  ASSERT_TRUE(chain.load(Chain::nodelets()));
  const auto connected = [&] {
    return color.getNumSubscribers() > 0 && depth.getNumSubscribers() > 0 && chain.isReporting();
  };
  ASSERT_TRUE(Chain::waitUntil(connected));
  for (int i = 0; i < 3; ++i) {
    const pf::RgbdFrame frame = emptyRoom().frame(i).frame;
    const CameraMessages m = toMessages(frame);
    auto jpeg = boost::make_shared<sensor_msgs::CompressedImage>(
        *compressedColor(frame.color, m.color->header));
    if (i == 1) jpeg->data.resize(jpeg->data.size() / 2);
    depth.publish(compressedDepth(frame.depth, m.color->header));
    color.publish(sensor_msgs::CompressedImageConstPtr(jpeg));
    CameraMessages info;
    info.info = m.info;
    if (i == 0) chain.send(info);  // once
    ASSERT_TRUE(chain.waitForStatuses(static_cast<std::size_t>(i + 1)));
    const auto status = chain.statuses().back();
    if (i != 1) {
      EXPECT_EQ(outcome(status), TrackingStatusMsg::FUSED) << status.reason;
      continue;
    }
    EXPECT_EQ(outcome(status), TrackingStatusMsg::BAD_INPUT);
    EXPECT_NE(status.reason.find("a compressed colour image is not whole"), std::string::npos)
        << status.reason;
    EXPECT_NE(status.reason.find("/compressed/rgb/image_color"), std::string::npos)
        << status.reason;
  }
}

TEST(ChainCameras, DepthOfAnotherSizeAndLaterStamps) {
  Chain chain("other_camera");
  chain.set("depth_stamp_offset_s", -0.1);
  SharpImages sharp(chain);
  ros::Publisher depth_info =
      chain.handle().advertise<sensor_msgs::CameraInfo>(topics::kDepthCameraInfo, 1, true);
  ASSERT_TRUE(chain.load());
  ASSERT_TRUE(Chain::waitUntil([&] { return depth_info.getNumSubscribers() > 0; }));
  const pf::RgbdFrame frame = emptyRoom().frame(0).frame;
  CameraMessages m = toMessages(frame);
  cv::Mat half;
  cv::resize(frame.depth, half, {}, 0.5, 0.5, cv::INTER_NEAREST);
  std_msgs::Header late = m.depth->header;
  late.stamp += ros::Duration(0.1);
  m.depth = toImage(half, "16UC1", late);

  auto status = chain.process(m);
  EXPECT_EQ(outcome(status), TrackingStatusMsg::BAD_INPUT);
  EXPECT_NE(status.reason.find("or a camera_info of depth"), std::string::npos) << status.reason;

  depth_info.publish(sensor_msgs::CameraInfoConstPtr(
      boost::make_shared<sensor_msgs::CameraInfo>(toCameraInfo(frame.camera.shrunk(2), late))));
  const CameraMessages next = toMessages(emptyRoom().frame(1).frame);
  m.color = next.color;
  m.info = next.info;
  m.depth->header.stamp = next.color->header.stamp + ros::Duration(0.1);
  status = chain.process(m);
  EXPECT_EQ(outcome(status), TrackingStatusMsg::FUSED) << status.reason;
  ASSERT_TRUE(Chain::waitUntil([&] { return sharp.depth != nullptr && sharp.color != nullptr; }));
  EXPECT_EQ(sharp.depth->header.stamp, m.color->header.stamp);
  EXPECT_TRUE(same(toDepth(sharp.depth), half));
  EXPECT_EQ(sharp.color->width, static_cast<unsigned>(half.cols));
}

TEST(ChainCameras, AnotherUnitOfDepthBecomesMetres) {
  Chain chain("unit");
  chain.set("depth_unit_m", 0.0005);
  SharpImages sharp(chain);
  ASSERT_TRUE(chain.load());
  const pf::RgbdFrame frame = emptyRoom().frame(0).frame;
  CameraMessages m = toMessages(frame);
  m.depth = toImage(frame.depth * 2, "16UC1", m.depth->header);
  EXPECT_EQ(outcome(chain.process(m)), TrackingStatusMsg::FUSED);
  ASSERT_TRUE(Chain::waitUntil([&] { return sharp.depth != nullptr; }));
  ASSERT_EQ(sharp.depth->encoding, "32FC1");
  cv::Mat metres;
  frame.depth.convertTo(metres, CV_32F, 1e-3);
  EXPECT_LT(cv::norm(toDepth(sharp.depth), metres, cv::NORM_INF), 1e-5);
}

}  // namespace
}  // namespace posefusion_ros
