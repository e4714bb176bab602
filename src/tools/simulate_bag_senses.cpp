// SPDX-License-Identifier: BSD-3-Clause
#include "simulate_bag_senses.hpp"

#include <nav_msgs/Odometry.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/JointState.h>
#include <tf2_msgs/TFMessage.h>

#include "posefusion/core/se3.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/bags/stage_messages.hpp"
#include "posefusion_ros/names.hpp"

namespace pf {
namespace {

// One by one: the core has an ImuSample of its own.
using posefusion_ros::frames::kOptical;
using simulator::ImuConfig;
using simulator::ImuSample;
using simulator::LegSample;
using simulator::LegsConfig;
using simulator::LegVariance;
using simulator::Scenario;
using simulator::Senses;
using simulator::Simulation;

constexpr char kImu[] = "/imu/data";
constexpr char kOdometry[] = "/odom";
constexpr char kJoints[] = "/joint_states";
constexpr char kTransforms[] = "/tf";
constexpr char kOdomFrame[] = "odom";
constexpr char kBaseFrame[] = "base_link";
constexpr char kImuFrame[] = "imu_link";
// Of roll and pitch, which gravity gives, and of what is not walked.
constexpr double kTilt_rad2 = 1e-5;
constexpr double kStill_m2 = 1e-8, kStill_rad2 = 1e-8;

geometry_msgs::Vector3 toVector(const Eigen::Vector3d& v) {
  geometry_msgs::Vector3 message;
  message.x = v.x(), message.y = v.y(), message.z = v.z();
  return message;
}

template <typename Covariance>
void setDiagonal(Covariance& covariance, const std::vector<double>& variances) {
  for (std::size_t i = 0; i < variances.size(); ++i) {
    covariance[i * (variances.size() + 1)] = variances[i];
  }
}

std::vector<double> diagonalOf(const LegVariance& variance) {
  return {variance.place_m2, variance.place_m2, variance.place_m2,
          kTilt_rad2,        kTilt_rad2,        variance.heading_rad2};
}

geometry_msgs::TransformStamped transformAt(const std_msgs::Header& header, const char* child,
                                            const Eigen::Isometry3d& T_parent_child) {
  geometry_msgs::TransformStamped transform;
  transform.header = header;
  transform.child_frame_id = child;
  transform.transform.translation = toVector(T_parent_child.translation());
  transform.transform.rotation = posefusion_ros::toPose(T_parent_child).orientation;
  return transform;
}

sensor_msgs::Imu imuMessage(const ImuSample& sample, const ImuConfig& c, std::int64_t stamp_ns) {
  sensor_msgs::Imu message;
  message.header = headerAt(stamp_ns, kImuFrame);
  message.orientation_covariance[0] = -1.0;  // it has none
  message.angular_velocity = toVector(sample.rate_rad_s);
  message.linear_acceleration = toVector(sample.force_m_s2);
  const double rate = c.gyro_noise_rad_s_rthz * c.gyro_noise_rad_s_rthz * c.rate_hz;
  const double force = c.accel_noise_m_s2_rthz * c.accel_noise_m_s2_rthz * c.rate_hz;
  setDiagonal(message.angular_velocity_covariance, {rate, rate, rate});
  setDiagonal(message.linear_acceleration_covariance, {force, force, force});
  return message;
}

/// The velocity is that since the sample before, in the frame of the base.
nav_msgs::Odometry odometryMessage(const LegSample& sample, const LegSample& before,
                                   const LegsConfig& c, std::int64_t stamp_ns) {
  nav_msgs::Odometry message;
  message.header = headerAt(stamp_ns, kOdomFrame);
  message.child_frame_id = kBaseFrame;
  message.pose.pose = posefusion_ros::toPose(sample.T_odom_base);
  setDiagonal(message.pose.covariance, diagonalOf(varianceOf(c, sample.way_m, sample.turned_rad)));
  const Vector6d velocity = logSe3(before.T_odom_base.inverse() * sample.T_odom_base) * c.rate_hz;
  message.twist.twist.linear = toVector(velocity.head<3>());
  message.twist.twist.angular = toVector(velocity.tail<3>());
  LegVariance step =
      varianceOf(c, sample.way_m - before.way_m, sample.turned_rad - before.turned_rad);
  step.place_m2 = (step.place_m2 + kStill_m2) * c.rate_hz * c.rate_hz;
  step.heading_rad2 = (step.heading_rad2 + kStill_rad2) * c.rate_hz * c.rate_hz;
  setDiagonal(message.twist.covariance, diagonalOf(step));
  return message;
}

void writeLegs(const LegSample& sample, const Eigen::Isometry3d& T_camera_imu,
               std::int64_t stamp_ns, NewBag& bag) {
  sensor_msgs::JointState joints;
  joints.header = headerAt(stamp_ns, "");
  joints.name = {"head_yaw", "head_pitch"};
  joints.position = {sample.neck.yaw_rad, sample.neck.pitch_rad};
  bag.write(kJoints, joints, joints.header);
  const auto odom = headerAt(stamp_ns, kOdomFrame);
  tf2_msgs::TFMessage tf;
  tf.transforms = {transformAt(odom, kBaseFrame, sample.T_odom_base),
                   transformAt(headerAt(stamp_ns, kBaseFrame), kOptical, sample.T_base_camera),
                   transformAt(headerAt(stamp_ns, kOptical), kImuFrame, T_camera_imu)};
  bag.write(kTransforms, tf, odom);
}

}  // namespace

void writeSenses(const Simulation& simulation, int frames, NewBag& bag) {
  const Senses senses = simulation.senses(frames);
  const Scenario& scenario = simulation.scenario();
  for (const auto& sample : senses.imu) {
    const auto message = imuMessage(sample, scenario.imu, simulation.stampOf(sample.time_s));
    bag.write(kImu, message, message.header);
  }
  const Eigen::Isometry3d T_camera_imu = imuFromCamera(scenario.imu).inverse();
  const LegSample* before = &senses.legs.front();
  for (const LegSample& sample : senses.legs) {
    const std::int64_t stamp_ns = simulation.stampOf(sample.time_s);
    const auto message = odometryMessage(sample, *before, scenario.legs, stamp_ns);
    bag.write(kOdometry, message, message.header);
    writeLegs(sample, T_camera_imu, stamp_ns, bag);
    before = &sample;
  }
}

}  // namespace pf
