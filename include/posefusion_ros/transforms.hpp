// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>

namespace posefusion_ros {

/// Name of a frame without the leading slash of older bags.
std::string plainFrame(const std::string& frame_id);

/// Rotation from a camera's optical frame (z forward, x right, y down) to a body frame (x forward,
/// y left, z up) that looks the same way (REP-103).
Eigen::Isometry3d bodyFromOptical();

/// Looks transforms up at the stamp of a frame. Waits in wall time, since simulated time may stand
/// still meanwhile. For any thread but that of the transform listener (its own).
class TransformLookup {
 public:
  explicit TransformLookup(double timeout_s) : timeout_s_(timeout_s), listener_(buffer_) {}

  /// T_target_source at `stamp`, or nothing and the reason in `error`: never a guess.
  std::optional<Eigen::Isometry3d> find(const std::string& target, const std::string& source,
                                        const ros::Time& stamp, std::string& error) const;

 private:
  double timeout_s_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
};

}  // namespace posefusion_ros
