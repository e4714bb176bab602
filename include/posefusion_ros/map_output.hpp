// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <optional>
#include <string>

#include "posefusion/slam/mapper.hpp"
#include "posefusion_ros/parameters.hpp"

namespace posefusion_ros {

/// Publishes what the map holds: the surfels for people to look at (throttled, only while someone
/// listens) and, after each frame, the view that the segmenter needs.
class MapOutput {
 public:
  /// Reads `surfels_period_s` and `surfels_max_points`.
  MapOutput(ros::NodeHandle& handle, Parameters& parameters, const std::string& map_frame);

  /// `T_map_start`: the core's map in the map frame; nothing is published while it is unknown.
  void publishSurfels(const pf::SurfelMap& map, const ros::Time& stamp,
                      const std::optional<Eigen::Isometry3d>& T_map_start);

  /// The view as it is after the frame of `stamp`. `reset`: the map was emptied on request.
  void publishView(const pf::ModelView& view, const ros::Time& stamp, bool reset);

  /// The next surfels go out at once.
  void reset() { surfels_sent_ = ros::Time(); }

 private:
  std::string map_frame_;
  double surfels_period_s_;
  int surfels_max_points_;
  ros::Publisher surfel_publisher_, view_publisher_;
  ros::Time surfels_sent_;
};

}  // namespace posefusion_ros
