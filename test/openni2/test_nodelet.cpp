// SPDX-License-Identifier: BSD-3-Clause
// What the driver publishes, and its services.
#include <dynamic_reconfigure/Reconfigure.h>
#include <sensor_msgs/SetCameraInfo.h>

#include "nodelet_fixture.hpp"

namespace pf::openni2 {
namespace {

TEST_F(DriverNodelet, PublishesWhatWasServed) {
  load();
  ASSERT_TRUE(streams(5));
  ASSERT_TRUE(color_info_.waitFor(5) && depth_info_.waitFor(5));
  for (const auto& image : color_.all()) {
    EXPECT_EQ(image->encoding, "rgb8");
    EXPECT_EQ(image->header.frame_id, "camera_rgb_optical_frame");
    EXPECT_EQ(image->step, 640u * 3);
    EXPECT_GT(servedIndex(*image, 400), 0) << "other pixels than were served";
  }
  for (const auto& image : depth_.all()) {
    EXPECT_EQ(image->encoding, "16UC1");
    EXPECT_EQ(image->header.frame_id, "camera_rgb_optical_frame") << "it is registered";
    EXPECT_EQ(image->step, 640u * 2);
    EXPECT_GT(servedIndex(*image, 400), 0) << "other pixels than were served";
  }
  EXPECT_EQ(virtualDevice().registration, 1);
  EXPECT_EQ(virtualDevice().sync, 1);
  EXPECT_EQ(virtualDevice().auto_exposure, 1);
}

TEST_F(DriverNodelet, StampsBothStreamsOfAMomentAlikeAndInTime) {
  load();
  ASSERT_TRUE(streams(10));
  int pairs = 0;
  for (const auto& depth : depth_.all()) {
    const int index = servedIndex(*depth, 400);
    for (const auto& color : color_.all()) {
      if (color->header.stamp != depth->header.stamp) continue;
      EXPECT_EQ(servedIndex(*color, 400), index);
      ++pairs;
    }
  }
  EXPECT_GE(pairs, 5);
  const auto images = color_.all();
  for (std::size_t i = 1; i < images.size(); ++i) {
    EXPECT_GT(images[i]->header.stamp, images[i - 1]->header.stamp);
  }
  EXPECT_NEAR((ros::Time::now() - images.back()->header.stamp).toSec(), 0.033, 0.5);
}

TEST_F(DriverNodelet, TimeOffsetsMoveTheStampsOfTheirStream) {
  set("color_time_offset", 0.0);
  set("depth_time_offset", -0.25);
  load();
  ASSERT_TRUE(streams(5));
  const auto color = color_.all().back();
  const int index = servedIndex(*color, 400);
  ASSERT_TRUE(depth_.waitFor(depth_.size() + 2));
  for (const auto& depth : depth_.all()) {
    const double after = (servedIndex(*depth, 400) - index) / 30.0;
    EXPECT_NEAR((depth->header.stamp - color->header.stamp).toSec(), after - 0.25, 0.02);
  }
}

TEST_F(DriverNodelet, CameraInfoIsFromTheFieldOfViewUntilItIsCalibrated) {
  load();
  ASSERT_TRUE(color_info_.waitFor(2) && depth_info_.waitFor(2) && streams(2));
  auto info = color_info_.all().back();
  EXPECT_NEAR(info->K[0], 525, 1e-3);
  EXPECT_NEAR(info->P[5], 525, 1e-3);
  EXPECT_DOUBLE_EQ(info->K[2], 319.5);
  EXPECT_EQ(depth_info_.all().back()->K, info->K);
  sensor_msgs::SetCameraInfo call;
  call.request.camera_info = *info;
  call.request.camera_info.K[0] = call.request.camera_info.P[0] = 531.5;
  ASSERT_TRUE(ros::service::call("/camera/rgb/set_camera_info", call));
  ASSERT_TRUE(call.response.success) << call.response.status_message;
  EXPECT_TRUE(eventually([&] { return color_info_.all().back()->K[0] == 531.5; }));
  EXPECT_TRUE(eventually([&] { return depth_info_.all().back()->K[0] == 531.5; }));
}

TEST_F(DriverNodelet, SharesOneImageWithAllSubscribersOfItsManager) {
  TopicKeeper<Image> other(nh_, "rgb/image_raw");
  load();
  ASSERT_TRUE(streams(3));
  ASSERT_TRUE(other.waitFor(color_.size() + 1));
  std::size_t shared = 0;
  for (const auto& image : color_.all()) {
    for (const auto& same : other.all()) shared += image.get() == same.get();
  }
  EXPECT_GE(shared, 3u);
}

TEST_F(DriverNodelet, PublishesUnregisteredDepthUnderItsOwnNameAndFrame) {
  set("depth_registration", false);
  TopicKeeper<Image> depth(nh_, "depth/image_raw");
  TopicKeeper<CameraInfo> info(nh_, "depth/camera_info");
  load();
  ASSERT_TRUE(depth.waitFor(2) && info.waitFor(2));
  EXPECT_EQ(depth.all().back()->header.frame_id, "camera_depth_optical_frame");
  EXPECT_EQ(info.all().back()->header.frame_id, "camera_depth_optical_frame");
  EXPECT_EQ(virtualDevice().registration, 0);
}

TEST_F(DriverNodelet, SetsTheExposureWhileItStreams) {
  load();
  ASSERT_TRUE(streams(2));
  dynamic_reconfigure::Reconfigure call;
  call.request.config.bools.resize(1);
  call.request.config.bools[0].name = "auto_exposure";
  call.request.config.bools[0].value = false;
  call.request.config.ints.resize(2);
  call.request.config.ints[0].name = "exposure";
  call.request.config.ints[0].value = 9;
  call.request.config.ints[1].name = "gain";
  call.request.config.ints[1].value = 200;
  ASSERT_TRUE(ros::service::call(std::string(kName) + "/set_parameters", call));
  EXPECT_TRUE(eventually([] { return virtualDevice().gain == 200; }));
  EXPECT_EQ(virtualDevice().auto_exposure, 0);
  EXPECT_EQ(virtualDevice().exposure, 9);
}

TEST_F(DriverNodelet, HoldsTheExposureAtItsLimit) {
  set("max_exposure", 25);
  load();
  ASSERT_TRUE(streams(2));
  EXPECT_EQ(virtualDevice().auto_exposure, 1);
  virtualDevice().automatic_exposure = 60;
  EXPECT_TRUE(eventually([] { return virtualDevice().exposure == 25; }));
  EXPECT_EQ(virtualDevice().auto_exposure, 0);
}

TEST_F(DriverNodelet, RecordsAFileAndPlaysIt) {
  load();
  ASSERT_TRUE(streams(2));
  EXPECT_FALSE(record(false).success) << "none runs";
  const auto started = record(true);
  ASSERT_TRUE(started.success) << started.message;
  EXPECT_FALSE(record(true).success) << "one runs";
  ASSERT_TRUE(streams(10));
  const auto stopped = record(false);
  EXPECT_TRUE(stopped.success);
  EXPECT_EQ(stopped.message, started.message);
  unload();
  virtualDevice().plug(false);
  set("device_id", stopped.message);
  load();
  EXPECT_TRUE(streams(5));
  EXPECT_TRUE(diagnosed(DiagnosticStatus::OK, "the file has been played"));
  for (const auto& image : color_.all()) EXPECT_GT(servedIndex(*image, 400), 0);
}

}  // namespace
}  // namespace pf::openni2

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "test_openni2_nodelet");
  const ros::NodeHandle keeps_the_node_alive;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  return RUN_ALL_TESTS();
}
