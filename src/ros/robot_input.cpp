// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/robot_input.hpp"

#include <limits>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion_ros/bags/conversions.hpp"

namespace posefusion_ros {
namespace {

constexpr std::uint32_t kSensorQueue = 1000;
// Samples that are not used, since no frame comes, are not kept for ever.
constexpr std::size_t kMostKept = 10000;
// A head turns little in so long; no frame waits for a transform.
constexpr double kOldestMount_s = 0.1;

Eigen::Vector3d toVector(const geometry_msgs::Vector3& v) { return {v.x, v.y, v.z}; }

/// Takes the messages up to the first after `stamp`.
template <typename Message>
std::vector<Message> takeUntil(const ros::Time& stamp, std::deque<Message>& messages) {
  std::vector<Message> taken;
  bool is_beyond = false;
  while (!messages.empty() && !is_beyond) {
    is_beyond = messages.front()->header.stamp > stamp;
    taken.push_back(messages.front());
    messages.pop_front();
  }
  return taken;
}

template <typename Message>
void keep(const Message& message, std::deque<Message>& messages) {
  messages.push_back(message);
  if (messages.size() > kMostKept) messages.pop_front();
}

}  // namespace

RobotInputSettings readRobotInput(Parameters& parameters, const std::string& odom_frame) {
  RobotInputSettings settings;
  settings.imu_topic = parameters.text("imu_topic", "");
  settings.odometry_topic = parameters.text("odometry_topic", "");
  settings.odometry_from_tf = parameters.flag("odometry_from_tf", false);
  settings.odom_frame = odom_frame;
  if (settings.odometry_from_tf && !settings.odometry_topic.empty()) {
    throw pf::InputError("odometry_topic is '" + settings.odometry_topic +
                         "' and odometry_from_tf is true, expected one of them");
  }
  if (settings.odometry_from_tf && odom_frame.empty()) {
    throw pf::InputError("odometry_from_tf is true and odom_frame is empty, expected its name");
  }
  return settings;
}

pf::ImuSample toImuSample(const sensor_msgs::Imu& message, const Eigen::Matrix3d& R_camera_imu) {
  pf::ImuSample sample;
  sample.stamp_ns = toNs(message.header.stamp);
  sample.rate_rad_s = R_camera_imu * toVector(message.angular_velocity);
  sample.acceleration_m_s2 = R_camera_imu * toVector(message.linear_acceleration);
  return sample;
}

pf::StampedPose toOdometryPose(const nav_msgs::Odometry& message,
                               const Eigen::Isometry3d& T_child_camera) {
  const auto& p = message.pose.pose.position;
  const auto& o = message.pose.pose.orientation;
  const auto rotation = pf::rotationOf({o.w, o.x, o.y, o.z});
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Eigen::Isometry3d T_odom_child = Eigen::Isometry3d::Identity();
  T_odom_child.translation() = Eigen::Vector3d(p.x, p.y, p.z);
  T_odom_child.linear() = rotation.value_or(Eigen::Matrix3d::Constant(kNone));
  return {toNs(message.header.stamp), T_odom_child * T_child_camera};
}

RobotInput::RobotInput(ros::NodeHandle& handle, const RobotInputSettings& settings)
    : settings_(settings) {
  const bool hears_imu = !settings.imu_topic.empty();
  const bool hears_odometry = !settings.odometry_topic.empty();
  if (!hears_imu && !hears_odometry && !settings.odometry_from_tf) return;
  LookupSettings lookup;
  lookup.timeout_s = 0;
  lookup.max_age_s = kOldestMount_s;
  lookup_ = std::make_unique<ListeningLookup>(lookup);
  if (hears_imu) {
    imu_subscriber_ = handle.subscribe(settings.imu_topic, kSensorQueue, &RobotInput::onImu, this);
  }
  if (hears_odometry) {
    odometry_subscriber_ =
        handle.subscribe(settings.odometry_topic, kSensorQueue, &RobotInput::onOdometry, this);
  }
}

void RobotInput::onImu(const sensor_msgs::Imu::ConstPtr& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  keep(message, imu_);
}

void RobotInput::onOdometry(const nav_msgs::Odometry::ConstPtr& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  keep(message, odometry_);
}

std::string RobotInput::tell(const std_msgs::Header& image, MappingSession& session) {
  std::string trouble;
  if (!lookup_) return trouble;
  tellImu(image, session, trouble);
  tellOdometry(image, session, trouble);
  return trouble;
}

void RobotInput::tellImu(const std_msgs::Header& image, MappingSession& session,
                         std::string& trouble) {
  std::vector<sensor_msgs::Imu::ConstPtr> messages;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    messages = takeUntil(image.stamp, imu_);
  }
  for (const auto& message : messages) {
    const std::string frame = plainFrame(message->header.frame_id);
    if (frame != imu_frame_) {
      std::string note;
      const auto T = (*lookup_)->find(plainFrame(image.frame_id), frame, image.stamp, note);
      if (!T) {
        trouble = "no inertial samples: " + note;
        continue;
      }
      R_camera_imu_ = T->linear();  // it does not move in the camera's axes
      imu_frame_ = frame;
    }
    session.addImu(toImuSample(*message, R_camera_imu_));
  }
}

void RobotInput::tellOdometry(const std_msgs::Header& image, MappingSession& session,
                              std::string& trouble) {
  const std::string camera = plainFrame(image.frame_id);
  std::string note;
  if (settings_.odometry_from_tf) {
    const auto T = (*lookup_)->find(settings_.odom_frame, camera, image.stamp, note);
    if (T && note.empty()) session.addOdometry({toNs(image.stamp), *T});
    if (!note.empty()) trouble = "no odometry: " + note;
    return;
  }
  std::vector<nav_msgs::Odometry::ConstPtr> messages;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    messages = takeUntil(image.stamp, odometry_);
  }
  for (const auto& message : messages) {
    const auto T =
        (*lookup_)->find(plainFrame(message->child_frame_id), camera, message->header.stamp, note);
    if (T) {
      session.addOdometry(toOdometryPose(*message, *T));
    } else {
      trouble = "no odometry: " + note;
    }
  }
}

}  // namespace posefusion_ros
