// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <posefusion/GetMap.h>
#include <ros/node_handle.h>

#include <functional>
#include <future>

namespace posefusion_ros {

/// The service `get_map`: the map as it is now, whether or not anything was published.
class MapQuery {
 public:
  /// Runs a task between two frames.
  using Post = std::function<std::future<void>(std::function<void()>)>;
  /// The stable surfels, at most so many, in the map frame; null while that is unknown.
  using Draw = std::function<sensor_msgs::PointCloud2::Ptr(std::size_t max_points)>;

  /// `handle`: private, of a queue that no work waits for.
  MapQuery(ros::NodeHandle& handle, Post post, Draw draw);

 private:
  bool answer(posefusion::GetMap::Request& request, posefusion::GetMap::Response& response);

  Post post_;
  Draw draw_;
  ros::ServiceServer service_;
};

}  // namespace posefusion_ros
