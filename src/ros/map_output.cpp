// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/map_output.hpp"

#include <sensor_msgs/PointCloud2.h>

#include "posefusion_ros/messages.hpp"
#include "posefusion_ros/model_view.hpp"
#include "posefusion_ros/names.hpp"
#include "posefusion_ros/surfel_cloud.hpp"

namespace posefusion_ros {

MapOutput::MapOutput(ros::NodeHandle& handle, Parameters& parameters, const std::string& map_frame)
    : map_frame_(map_frame),
      surfels_period_s_(parameters.number("surfels_period_s", 1.0, {0.0, 3600.0})),
      surfels_max_points_(parameters.integer("surfels_max_points", 500000, {0, 100000000})),
      surfel_publisher_(handle.advertise<sensor_msgs::PointCloud2>(topics::kSurfels, 1, true)),
      // Latched: the segmenter may connect after the first frame.
      view_publisher_(handle.advertise<ModelViewMsg>(topics::kModelView, 1, true)) {}

void MapOutput::publishSurfels(const pf::SurfelMap& map, const ros::Time& stamp,
                               const std::optional<Eigen::Isometry3d>& T_map_start) {
  if (!T_map_start || surfel_publisher_.getNumSubscribers() == 0) return;
  if (!surfels_sent_.isZero() && (stamp - surfels_sent_).toSec() < surfels_period_s_) return;
  surfels_sent_ = stamp;
  const auto cloud = toCloud(map, *T_map_start, surfels_max_points_);
  cloud->header.stamp = stamp;
  cloud->header.frame_id = map_frame_;
  surfel_publisher_.publish(sensor_msgs::PointCloud2::ConstPtr(cloud));
}

void MapOutput::publishView(const pf::ModelView& view, const ros::Time& stamp, bool reset) {
  std_msgs::Header header;
  header.stamp = stamp;
  const ModelViewMsg::Ptr message = toMessage(view, header);
  message->reset = static_cast<unsigned char>(reset);
  view_publisher_.publish(ModelViewMsg::ConstPtr(message));
}

}  // namespace posefusion_ros
