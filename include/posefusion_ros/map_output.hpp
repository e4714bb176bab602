// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/PointCloud2.h>

#include <functional>
#include <optional>
#include <string>

#include "posefusion/slam/mapper.hpp"
#include "posefusion_ros/running_settings.hpp"

namespace posefusion_ros {

/// Publishes what the map holds: the surfels for display (throttled, only with subscribers; at once
/// to a new subscriber) and, after each frame, the view that the segmenter needs.
class MapOutput {
 public:
  /// `newcomer` is called, in the queue of `handle`, when a node subscribes to the surfels:
  /// publishSurfels() sends it the map even where no frame comes any more.
  MapOutput(ros::NodeHandle& handle, const PublishingConfig& config, const std::string& map_frame,
            const std::function<void()>& newcomer);

  /// No more surfels, and no call of `newcomer` once this has returned.
  void close() { surfel_publisher_.shutdown(); }

  void set(const PublishingConfig& config) { config_ = config; }

  /// `T_map_start`: the core's map in the map frame; nothing is published while it is unknown.
  void publishSurfels(const pf::SurfelMap& map, const ros::Time& stamp,
                      const std::optional<Eigen::Isometry3d>& T_map_start);

  /// The stable surfels, at most so many (0: all); null while the map frame is unknown.
  sensor_msgs::PointCloud2::Ptr cloud(const pf::SurfelMap& map, const ros::Time& stamp,
                                      const std::optional<Eigen::Isometry3d>& T_map_start,
                                      std::size_t max_points) const;

  /// The view as it is after the frame of `stamp`. `T_map_start`: the core's map in the map frame,
  /// if that is known. `reset`: the map was emptied on request.
  void publishView(const pf::ModelView& view, const ros::Time& stamp,
                   const std::optional<Eigen::Isometry3d>& T_map_start, bool reset);

  /// The next surfels go out at once.
  void reset() { surfels_sent_ = ros::Time(); }

 private:
  std::string map_frame_;
  PublishingConfig config_;
  ros::Publisher surfel_publisher_, view_publisher_;
  ros::Time surfels_sent_;
};

}  // namespace posefusion_ros
