// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nav_msgs/Path.h>
#include <ros/node_handle.h>
#include <tf2_ros/transform_broadcaster.h>

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "posefusion/slam/mapper.hpp"
#include "posefusion_ros/parameters.hpp"
#include "posefusion_ros/parent_watch.hpp"
#include "posefusion_ros/running_settings.hpp"
#include "posefusion_ros/transforms.hpp"

namespace posefusion_ros {

/// Frames and rates of the published poses.
struct PoseOutputSettings {
  bool publish_tf = true;
  bool tf_while_lost = true;  ///< with odom_frame: map -> odom goes on as it was known last
  std::string map_frame;
  std::string odom_frame;  ///< empty: no odometry, map -> base is published
  std::string base_frame;  ///< empty: the optical frame of the camera
  LookupSettings lookup;
  PublishingConfig publishing;
};

PoseOutputSettings readPoseOutput(Parameters& parameters, bool lossless);

/// Publishes where the camera is: TF, odometry, pose and path, in a map frame with z up.
///
/// The core's map begins at the first camera pose. The map frame begins at the base (odometry where
/// there is one) as TF has it at that time; without a base frame the first camera counts as level.
/// A loaded map keeps the map frame that it was made in; where its file has none (made offline), it
/// begins at the base too, whose camera is taken to be mounted as it was then. Not thread safe.
class PoseOutput {
 public:
  PoseOutput(ros::NodeHandle& handle, const PoseOutputSettings& settings);

  /// Publishes the pose of a located frame; `image` is the header of its colour image. False when
  /// nothing could be published, for want of a transform. `note`: what is missing, which transform
  /// is older than the image, or which node sends ours already (it is not sent then); empty when
  /// all is well.
  bool publish(const std_msgs::Header& image, const pf::FrameStatus& status, std::string& note);

  /// Where the robot may be while the camera is not located, as a PoseWithCovarianceStamped; no
  /// transform, which could not carry the uncertainty. Nothing before the first located frame, and
  /// where a transform is wanting.
  void publishProvisional(const std_msgs::Header& image, const pf::ProvisionalPose& pose);

  /// The camera of a base that is at `T_map_base`, by its mount at the stamp of an image; without a
  /// base frame, of a camera that is held level there and looks along x. Nothing where a transform
  /// is wanting: `note` says which.
  std::optional<Eigen::Isometry3d> cameraOf(const std_msgs::Header& image,
                                            const Eigen::Isometry3d& T_map_base, std::string& note);

  const std::string& mapFrame() const { return settings_.map_frame; }

  /// No pose is known: sends map -> odom as it was known last (see PoseOutputSettings), unless it
  /// was sent with this stamp, or a later one, already. The robot moves on by its odometry. Without
  /// odometry nothing is sent: it would be a pose, and a false one.
  void hold(const ros::Time& stamp);

  /// The core's map in the map frame; nothing until the first pose could be published.
  const std::optional<Eigen::Isometry3d>& mapFromStart() const { return T_map_start_; }

  /// Loops have moved the poses reported so far: the path follows. `corrected`: of the camera.
  void correct(const pf::Trajectory& corrected);

  /// Stamps begin anew, the map goes on: so does the transform, the path begins anew.
  void restartClock();

  /// Another map, that begins with the next pose.
  void reset();

  /// Another map, that began in a session before; `T_map_start`: where it stood then, if that is
  /// known.
  void load(const std::optional<Eigen::Isometry3d>& T_map_start);

  void set(const PublishingConfig& publishing) { settings_.publishing = publishing; }

 private:
  struct Links;  // camera and odometry of the robot at the stamp
  bool lookAtMount(const std_msgs::Header& image, Links& links, std::string& note);
  bool look(const std_msgs::Header& image, Links& links, std::string& note);
  /// Says why it is not sent; empty when it is.
  std::string sendTransform(const ros::Time& stamp, const std::string& child,
                            const Eigen::Isometry3d& T);
  void sendOdometry(const ros::Time& stamp, const Links& links, const Eigen::Isometry3d& T_map_base,
                    const pf::Matrix6d& covariance);
  void extendPath(const geometry_msgs::PoseStamped& pose, const Eigen::Isometry3d& T_base_camera);

  PoseOutputSettings settings_;
  ros::Publisher odometry_, pose_, pose_with_covariance_, provisional_, path_publisher_;
  std::unique_ptr<ListeningLookup> lookup_;        // only where a frame has to be looked up
  std::unique_ptr<ListeningParentWatch> parents_;  // only where transforms are sent
  bool sends_ = false;                             // the last transform was sent
  std::optional<Eigen::Isometry3d> T_map_odom_;    // as known last
  ros::Time sent_;                                 // newest stamp of a transform
  tf2_ros::TransformBroadcaster broadcaster_;
  std::optional<Eigen::Isometry3d> T_map_start_;
  bool is_loaded_ = false;
  std::optional<Eigen::Isometry3d> T_map_base_before_;
  ros::Time before_, path_sent_;
  nav_msgs::Path path_;
  std::vector<Eigen::Isometry3d> path_mounts_;  // T_base_camera of each pose of the path
};

}  // namespace posefusion_ros
