// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/robot_input.hpp"

#include <gtest/gtest.h>

#include "posefusion/core/error.hpp"

namespace posefusion_ros {
namespace {

Parameters parametersOf(const std::map<std::string, std::string>& values, bool from_tf) {
  XmlRpc::XmlRpcValue tree;
  for (const auto& [name, value] : values) tree[name] = value;
  tree["odometry_from_tf"] = XmlRpc::XmlRpcValue(from_tf);
  return Parameters(tree, "/fusion");
}

TEST(RobotInputSettings, AreCheckedAgainstEachOther) {
  Parameters none = parametersOf({}, false);
  EXPECT_TRUE(readRobotInput(none, "").imu_topic.empty());
  Parameters both = parametersOf({{"odometry_topic", "/odom"}}, true);
  EXPECT_THROW(readRobotInput(both, "odom"), pf::InputError);
  Parameters nameless = parametersOf({}, true);
  EXPECT_THROW(readRobotInput(nameless, ""), pf::InputError);
  Parameters good = parametersOf({{"imu_topic", "/imu/data"}}, true);
  const RobotInputSettings settings = readRobotInput(good, "odom");
  EXPECT_EQ(settings.imu_topic, "/imu/data");
  EXPECT_TRUE(settings.odometry_from_tf);
}

TEST(RobotInput, SamplesAreTurnedIntoTheCamerasAxes) {
  sensor_msgs::Imu message;
  message.header.stamp = ros::Time(5);
  message.angular_velocity.z = 0.5;
  message.linear_acceleration.z = 9.81;  // of a body: z is up
  Eigen::Matrix3d R_camera_body;
  R_camera_body << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const pf::ImuSample sample = toImuSample(message, R_camera_body);
  EXPECT_EQ(sample.stamp_ns, 5'000'000'000);
  EXPECT_TRUE(sample.acceleration_m_s2.isApprox(Eigen::Vector3d(0, -9.81, 0)));
  EXPECT_TRUE(sample.rate_rad_s.isApprox(Eigen::Vector3d(0, -0.5, 0)));
}

TEST(RobotInput, OdometryIsCarriedToTheCamera) {
  nav_msgs::Odometry message;
  message.pose.pose.position.x = 2;
  message.pose.pose.orientation.w = 1;
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
  T_base_camera.translation().z() = 1.2;
  const Eigen::Isometry3d T = toOdometryPose(message, T_base_camera).T_world_camera;
  EXPECT_EQ(T.translation(), Eigen::Vector3d(2, 0, 1.2));
  message.pose.pose.orientation.w = 0;
  EXPECT_FALSE(pf::isRigid(toOdometryPose(message, T_base_camera).T_world_camera))
      << "a quaternion of zeros is no rotation";
}

}  // namespace
}  // namespace posefusion_ros
