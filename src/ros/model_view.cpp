// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/model_view.hpp"

#include <sensor_msgs/image_encodings.h>

#include <boost/make_shared.hpp>

#include "posefusion/core/error.hpp"
#include "posefusion_ros/bags/conversions.hpp"

namespace posefusion_ros {
namespace {

using RowMajor34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

using sensor_msgs::image_encodings::TYPE_32FC1;
using sensor_msgs::image_encodings::TYPE_8UC1;

void copyPlane(const cv::Mat& plane, const std_msgs::Header& header, sensor_msgs::Image& image) {
  const std::string encoding = plane.type() == CV_8UC1 ? TYPE_8UC1 : TYPE_32FC1;
  cv_bridge::CvImage(header, encoding, plane).toImageMsg(image);
}

cv::Mat planeOf(const sensor_msgs::Image& image, const ModelViewMsg::ConstPtr& owner,
                const std::string& encoding) {
  try {
    if (image.encoding == encoding) return cv_bridge::toCvShare(image, owner)->image;
  } catch (const cv_bridge::Exception& error) {
    throw pf::InputError(std::string("model view: ") + error.what());
  }
  throw pf::InputError("model view: encoding '" + image.encoding + "', expected " + encoding);
}

}  // namespace

ModelViewMsg::Ptr toMessage(const pf::ModelView& view, const std_msgs::Header& header) {
  auto message = boost::make_shared<ModelViewMsg>();
  message->header = header;
  if (view.empty()) return message;
  message->rendered_at = toTime(view.stamp_ns);
  message->camera = toCameraInfo(view.camera, header);
  message->fragment = static_cast<std::uint32_t>(view.fragment);
  Eigen::Map<RowMajor34>(message->map_from_camera.data()) = view.T_map_camera.matrix().topRows<3>();
  Eigen::Map<RowMajor34>(message->map_from_uncorrected.data()) =
      view.T_map_uncorrected.matrix().topRows<3>();
  if (view.T_world_map) {
    Eigen::Map<RowMajor34>(message->frame_from_map.data()) =
        view.T_world_map->matrix().topRows<3>();
  }
  copyPlane(view.depth_m, header, message->depth);
  copyPlane(view.stable, header, message->stable);
  return message;
}

pf::ModelView fromMessage(const ModelViewMsg::ConstPtr& message) {
  pf::ModelView view;
  if (message->depth.data.empty()) return view;
  view.stamp_ns = toNs(message->rendered_at);
  view.camera = toCamera(message->camera, false);
  view.fragment = static_cast<int>(message->fragment);
  view.T_map_camera.matrix().topRows<3>() =
      Eigen::Map<const RowMajor34>(message->map_from_camera.data());
  view.T_map_uncorrected.matrix().topRows<3>() =
      Eigen::Map<const RowMajor34>(message->map_from_uncorrected.data());
  const Eigen::Map<const RowMajor34> frame_from_map(message->frame_from_map.data());
  if (!frame_from_map.isZero(0)) {
    view.T_world_map = Eigen::Isometry3d::Identity();
    view.T_world_map->matrix().topRows<3>() = frame_from_map;
  }
  view.depth_m = planeOf(message->depth, message, TYPE_32FC1);
  view.stable = planeOf(message->stable, message, TYPE_8UC1);
  return view;
}

}  // namespace posefusion_ros
