// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/map_query.hpp"

#include <utility>

namespace posefusion_ros {

MapQuery::MapQuery(ros::NodeHandle& handle, Post post, Draw draw)
    : post_(std::move(post)),
      draw_(std::move(draw)),
      service_(handle.advertiseService("get_map", &MapQuery::answer, this)) {}

bool MapQuery::answer(posefusion::GetMap::Request& request,
                      posefusion::GetMap::Response& response) {
  sensor_msgs::PointCloud2::Ptr cloud;
  try {
    post_([&] { cloud = draw_(request.max_points); }).get();
  } catch (const std::future_error&) {
    response.message = "shutting down";
    return true;
  }
  response.success = static_cast<unsigned char>(cloud != nullptr);
  if (cloud) {
    response.cloud = std::move(*cloud);
  } else {
    response.message = "there is no map yet: no pose was published";
  }
  return true;
}

}  // namespace posefusion_ros
