// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <Eigen/Geometry>
#include <vector>

#include "posefusion/map/surfel_map.hpp"

namespace posefusion_ros {

/// A point of the cloud, as it lies in the message.
struct SurfelPoint {
  float x, y, z;  ///< map frame, m
  float rgb;      ///< packed as PCL does
  float normal_x, normal_y, normal_z;
  float radius;  ///< m
  float confidence;
};

/// The points (width of them) of a cloud that toCloud() made; null for any other.
const SurfelPoint* surfelsOf(const sensor_msgs::PointCloud2& cloud);

/// A cloud of these points, without a header.
sensor_msgs::PointCloud2::Ptr toCloud(const std::vector<SurfelPoint>& points);

/// The stable surfels as a cloud: x y z (m), rgb (packed as PCL does), normal_x normal_y normal_z,
/// radius (m), confidence (probability that it stands still), all 32-bit floats, moved by
/// T_map_start into the map frame. Where there are more than `max_points` (0: any number), evenly
/// many are left out.
sensor_msgs::PointCloud2::Ptr toCloud(const pf::SurfelMap& map,
                                      const Eigen::Isometry3d& T_map_start, std::size_t max_points);

}  // namespace posefusion_ros
