// SPDX-License-Identifier: BSD-3-Clause
// The robot's odometry and inertial sensor beside the camera.
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/Imu.h>
#include <tf2_eigen/tf2_eigen.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <Eigen/Geometry>
#include <limits>

#include "diagnostics_listener.hpp"

namespace posefusion_ros {
namespace {

constexpr char kBase[] = "legs_base", kImu[] = "legs_imu";

/// A chain that hears odometry of a base under the camera, and a sensor beside it.
class ChainRobot : public testing::Test {
 protected:
  void load(const std::string& space) {
    chain_ = std::make_unique<Chain>(space);
    chain_->set("odometry_topic", std::string("legs_odom"));
    chain_->set("imu_topic", std::string("head_imu"));
    diagnostics_ = std::make_unique<Diagnostics>(*chain_);
    odometry_ = chain_->handle().advertise<nav_msgs::Odometry>("legs_odom", 1000);
    imu_ = chain_->handle().advertise<sensor_msgs::Imu>("head_imu", 1000);
    T_base_camera_.linear() = pf::bodyFromOptical().linear();
    T_base_camera_.translation() << 0.1, 0, 1.3;
    broadcaster_.sendTransform({link(kBase, frames::kOptical, T_base_camera_),
                                link(frames::kOptical, kImu, pf::bodyFromOptical().inverse())});
    ASSERT_TRUE(chain_->load());
    ASSERT_TRUE(Chain::waitUntil(
        [this] { return odometry_.getNumSubscribers() > 0 && imu_.getNumSubscribers() > 0; }));
    ros::WallDuration(0.5).sleep();  // the listener of the chain hears the static transforms
  }
  void TearDown() override {
    diagnostics_.reset();
    chain_.reset();
  }

  static geometry_msgs::TransformStamped link(const char* parent, const char* child,
                                              const Eigen::Isometry3d& T) {
    geometry_msgs::TransformStamped link = tf2::eigenToTransform(T);
    link.header.frame_id = parent;
    link.child_frame_id = child;
    return link;
  }

  nav_msgs::Odometry odometryAt(int frame) const {
    nav_msgs::Odometry message;
    message.header.stamp = toTime(emptyRoom().stamp(frame));
    message.header.frame_id = "legs_odom_frame";
    message.child_frame_id = kBase;
    message.pose.pose = tf2::toMsg(emptyRoom().pose(frame) * T_base_camera_.inverse());
    return message;
  }

  /// The camera's turn since the frame before, in the sensor's axes.
  sensor_msgs::Imu imuAt(int frame) const {
    const double elapsed_s =
        1e-9 * static_cast<double>(emptyRoom().stamp(frame) - emptyRoom().stamp(frame - 1));
    const Eigen::Matrix3d turn =
        emptyRoom().pose(frame - 1).linear().transpose() * emptyRoom().pose(frame).linear();
    const Eigen::Vector3d rate = pf::bodyFromOptical().linear() * pf::logSo3(turn) / elapsed_s;
    sensor_msgs::Imu message;
    message.header.stamp = toTime(emptyRoom().stamp(frame));
    message.header.frame_id = kImu;
    message.angular_velocity.x = rate.x();
    message.angular_velocity.y = rate.y();
    message.angular_velocity.z = rate.z();
    message.linear_acceleration.z = 9.81;
    return message;
  }

  void walk(int frames) {
    for (int i = 0; i < frames; ++i) {
      odometry_.publish(odometryAt(i));
      if (i > 0) imu_.publish(imuAt(i));
      ros::WallDuration(0.02).sleep();  // topics have no common order
      chain_->process(toMessages(emptyRoom().frame(i).frame));
    }
  }

  Eigen::Isometry3d T_base_camera_ = Eigen::Isometry3d::Identity();
  tf2_ros::StaticTransformBroadcaster broadcaster_;
  std::unique_ptr<Chain> chain_;
  std::unique_ptr<Diagnostics> diagnostics_;
  ros::Publisher odometry_, imu_;
};

TEST_F(ChainRobot, SensorsThatMeasureTheMotionAreUsed) {
  load("legs");
  walk(emptyRoom().frameCount());
  EXPECT_TRUE(diagnostics_->waitFor("fusion", "odometry believed", "yes"));
  EXPECT_EQ(diagnostics_->value("fusion", "odometry left out"), "0");
  EXPECT_NE(diagnostics_->value("fusion", "imu received"), "none");
}

TEST_F(ChainRobot, GarbageIsNamedAndHarmsNothing) {
  load("bad_legs");
  nav_msgs::Odometry bad = odometryAt(0);
  bad.pose.pose.position.x = std::numeric_limits<double>::quiet_NaN();
  odometry_.publish(bad);
  bad = odometryAt(1);
  bad.pose.pose.orientation = geometry_msgs::Quaternion();
  odometry_.publish(bad);
  ros::WallDuration(0.1).sleep();
  TrackingStatusMsg status;
  for (int i = 0; i < 5; ++i) status = chain_->process(toMessages(emptyRoom().frame(i).frame));
  EXPECT_EQ(outcome(status), TrackingStatusMsg::FUSED);
  EXPECT_TRUE(diagnostics_->waitFor("fusion", "odometry left out", "2"));
  EXPECT_NE(diagnostics_->value("fusion", "odometry left out, why").find("rigid"),
            std::string::npos);
  EXPECT_EQ(diagnostics_->value("fusion", "odometry believed"), "no");
}

}  // namespace
}  // namespace posefusion_ros
