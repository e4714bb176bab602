// SPDX-License-Identifier: BSD-3-Clause
#include <dynamic_reconfigure/Reconfigure.h>
#include <geometry_msgs/TransformStamped.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>
#include <std_srvs/SetBool.h>
#include <tf2_ros/transform_listener.h>

#include <filesystem>

namespace {

TEST(Launch, DepthHasTheFrameOfColourAndTheSameTime) {
  ros::NodeHandle nh;
  const auto wait = ros::Duration(30);
  const auto color =
      ros::topic::waitForMessage<sensor_msgs::Image>("/camera/rgb/image_raw", nh, wait);
  const auto depth = ros::topic::waitForMessage<sensor_msgs::Image>(
      "/camera/depth_registered/image_raw", nh, wait);
  ASSERT_TRUE(color && depth);
  EXPECT_EQ(color->header.frame_id, "camera_rgb_optical_frame");
  EXPECT_EQ(depth->header.frame_id, color->header.frame_id);
  EXPECT_EQ(depth->width, color->width);
  EXPECT_EQ(depth->height, color->height);
}

TEST(Launch, TheOpticalFrameLooksForward) {
  tf2_ros::Buffer buffer;
  const tf2_ros::TransformListener listener(buffer);
  const auto t = buffer.lookupTransform("camera_link", "camera_rgb_optical_frame", ros::Time(0),
                                        ros::Duration(20));
  EXPECT_DOUBLE_EQ(t.transform.translation.y, -0.045);
  // z of the optical frame is x of the link: (x, y, z, w) = (-1, 1, -1, 1) / 2.
  EXPECT_NEAR(t.transform.rotation.x * t.transform.rotation.w, -0.25, 1e-9);
  EXPECT_NEAR(t.transform.rotation.y * t.transform.rotation.w, 0.25, 1e-9);
  EXPECT_NEAR(t.transform.rotation.z * t.transform.rotation.w, -0.25, 1e-9);
}

TEST(Launch, RecordsWhereTheManagerRuns) {
  ASSERT_TRUE(ros::service::waitForService("/camera/driver/record", 20000));
  std_srvs::SetBool call;
  call.request.data = true;
  ASSERT_TRUE(ros::service::call("/camera/driver/record", call));
  ASSERT_TRUE(call.response.success) << call.response.message;
  ros::Duration(0.5).sleep();
  call.request.data = false;
  ASSERT_TRUE(ros::service::call("/camera/driver/record", call));
  ASSERT_TRUE(call.response.success) << call.response.message;
  EXPECT_TRUE(std::filesystem::remove(call.response.message)) << call.response.message;
}

TEST(Launch, TakesSettings) {
  ASSERT_TRUE(ros::service::waitForService("/camera/driver/set_parameters", 20000));
  dynamic_reconfigure::Reconfigure call;
  call.request.config.ints.resize(1);
  call.request.config.ints[0].name = "max_exposure";
  call.request.config.ints[0].value = 12;
  ASSERT_TRUE(ros::service::call("/camera/driver/set_parameters", call));
  bool found = false;
  for (const auto& value : call.response.config.ints) {
    found |= value.name == "max_exposure" && value.value == 12;
  }
  EXPECT_TRUE(found);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "test_openni2_launch");
  const ros::NodeHandle keeps_the_node_alive;
  return RUN_ALL_TESTS();
}
