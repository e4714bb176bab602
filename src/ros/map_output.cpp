// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/map_output.hpp"

#include "posefusion_ros/bags/messages.hpp"
#include "posefusion_ros/model_view.hpp"
#include "posefusion_ros/names.hpp"
#include "posefusion_ros/surfel_cloud.hpp"

namespace posefusion_ros {

MapOutput::MapOutput(ros::NodeHandle& handle, const PublishingConfig& config,
                     const std::string& map_frame, const std::function<void()>& newcomer)
    : map_frame_(map_frame),
      config_(config),
      surfel_publisher_(handle.advertise<sensor_msgs::PointCloud2>(
          topics::kSurfels, 1, [newcomer](const ros::SingleSubscriberPublisher&) { newcomer(); },
          ros::SubscriberStatusCallback(), ros::VoidConstPtr(), true)),
      // Latched: the segmenter may connect after the first frame.
      view_publisher_(handle.advertise<ModelViewMsg>(topics::kModelView, 1, true)) {}

void MapOutput::publishSurfels(const pf::SurfelMap& map, const ros::Time& stamp,
                               const std::optional<Eigen::Isometry3d>& T_map_start) {
  if (!T_map_start || surfel_publisher_.getNumSubscribers() == 0) return;
  const double age_s = (stamp - surfels_sent_).toSec();
  if (!surfels_sent_.isZero() && age_s < config_.surfels_period_s) return;
  surfels_sent_ = stamp;
  const auto max_points = static_cast<std::size_t>(config_.surfels_max_points);
  surfel_publisher_.publish(
      sensor_msgs::PointCloud2::ConstPtr(cloud(map, stamp, T_map_start, max_points)));
}

sensor_msgs::PointCloud2::Ptr MapOutput::cloud(const pf::SurfelMap& map, const ros::Time& stamp,
                                               const std::optional<Eigen::Isometry3d>& T_map_start,
                                               std::size_t max_points) const {
  if (!T_map_start) return nullptr;
  auto cloud = toCloud(map, *T_map_start, max_points);
  cloud->header.stamp = stamp;
  cloud->header.frame_id = map_frame_;
  return cloud;
}

void MapOutput::publishView(const pf::ModelView& view, const ros::Time& stamp,
                            const std::optional<Eigen::Isometry3d>& T_map_start, bool reset) {
  std_msgs::Header header;
  header.stamp = stamp;
  pf::ModelView placed = view;
  placed.T_world_map = T_map_start;
  const ModelViewMsg::Ptr message = toMessage(placed, header);
  message->map_frame = map_frame_;
  message->reset = static_cast<unsigned char>(reset);
  view_publisher_.publish(ModelViewMsg::ConstPtr(message));
}

}  // namespace posefusion_ros
