// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <ros/time.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "posefusion/core/se3.hpp"
#include "posefusion_ros/parameters.hpp"

namespace posefusion_ros {

/// Name of a frame without the leading slash of older bags.
std::string plainFrame(const std::string& frame_id);

/// The covariance of a body's pose in a parent frame as geometry_msgs/PoseWithCovariance has it:
/// of the position of the body's origin (m) and of the rotation about the parent's axes (rad).
/// `camera` is that of a small motion (m, rad) of a camera on the body, in the camera's own axes:
/// T_parent_camera exp(motion). By the adjoint of T_body_camera (Barfoot 2017, eq. 7.37), so that a
/// turn of the camera moves the body by its distance from the camera.
pf::Matrix6d poseCovariance(const Eigen::Isometry3d& T_parent_body,
                            const Eigen::Isometry3d& T_body_camera, const pf::Matrix6d& camera);

/// How transforms are looked up.
struct LookupSettings {
  double timeout_s = 0.1;  ///< a wait lasts so long at most, wall time
  double max_age_s = 0.2;  ///< the newest transform is good enough when it is no older
  bool exact = false;      ///< only that at the stamp: for results that do not depend on timing
};

/// Reads `tf_timeout_s` and `tf_max_age_s`. `lossless`: nothing may depend on timing.
LookupSettings readLookup(Parameters& parameters, bool lossless);

/// Looks transforms up at the stamp of a frame, without holding up frame after frame: live, only
/// the first of two frames is waited for, later on the newest one stands in. Where they have to be
/// exact each is waited for, until a wait is in vain; then again once it came by itself. Waits in
/// wall time, since simulated time may stand still. For any thread but that of the listener.
class TransformLookup {
 public:
  TransformLookup(const tf2::BufferCore& buffer, const LookupSettings& settings)
      : buffer_(buffer), settings_(settings) {}

  /// T_target_source at `stamp`, with an empty `note`; or the newest one, with a note that says how
  /// old it is; or nothing, with the reason as note.
  std::optional<Eigen::Isometry3d> find(const std::string& target, const std::string& source,
                                        const ros::Time& stamp, std::string& note);

 private:
  std::optional<Eigen::Isometry3d> look(const std::string& target, const std::string& source,
                                        const ros::Time& stamp, std::string& note) const;
  std::optional<geometry_msgs::TransformStamped> at(const std::string& target,
                                                    const std::string& source,
                                                    const ros::Time& stamp,
                                                    std::string& note) const;

  const tf2::BufferCore& buffer_;
  LookupSettings settings_;
  std::map<std::pair<std::string, std::string>, bool> waits_;  // by target and source
};

/// A lookup in what it hears on /tf and /tf_static, in a thread of its own.
class ListeningLookup {
 public:
  explicit ListeningLookup(const LookupSettings& settings)
      : listener_(buffer_), lookup_(buffer_, settings) {}
  TransformLookup* operator->() { return &lookup_; }

 private:
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  TransformLookup lookup_;
};

}  // namespace posefusion_ros
