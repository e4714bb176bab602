// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cv_bridge/cv_bridge.h>
#include <ros/time.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <string>

#include "posefusion/core/frame.hpp"

namespace posefusion_ros {

inline ros::Time toTime(std::int64_t stamp_ns) { return ros::Time().fromNSec(stamp_ns); }
inline std::int64_t toNs(const ros::Time& stamp) {
  return static_cast<std::int64_t>(stamp.toNSec());
}

/// Colour as CV_8UC3 R G B: a view of the message's bytes for rgb8, a converted copy for bgr8,
/// rgba8, bgra8, mono8, bayer_*8, yuv422 (U Y V Y) and yuv422_yuy2 (Y U Y V). Throws InputError
/// naming the encoding otherwise, or the bytes that are missing.
cv::Mat toColor(const sensor_msgs::ImageConstPtr& image);
/// JPEG, PNG.
cv::Mat toColor(const sensor_msgs::CompressedImageConstPtr& image);

/// Depth as a view of the message's bytes: 16UC1 or mono16 (millimetres), 32FC1 (metres). Throws
/// InputError naming the encoding otherwise.
cv::Mat toDepth(const sensor_msgs::ImageConstPtr& image);
/// As compressed_depth_image_transport sends it (PNG, not RVL), or a plain 16-bit PNG
/// or TIFF (millimetres). Throws InputError naming the format.
cv::Mat toDepth(const sensor_msgs::CompressedImageConstPtr& image);

/// The camera of the images that come with `info`, honouring binning and region of interest.
/// `rectified`: the images are free of distortion, so P holds; else K and D. Throws InputError
/// naming the field that no camera can have, or the distortion model where it is none of
/// plumb_bob, rational_polynomial (8 coefficients) and equidistant.
pf::PinholeCamera toCamera(const sensor_msgs::CameraInfo& info, bool rectified);

/// K, D, P and size of a camera.
sensor_msgs::CameraInfo toCameraInfo(const pf::PinholeCamera& camera,
                                     const std_msgs::Header& header);

/// A frame whose pixels are those of the messages wherever the encoding allows: the messages must
/// live as long as it. Stamp of the colour. Throws InputError as above, or with what defectOf()
/// says.
pf::RgbdFrame toFrame(const sensor_msgs::ImageConstPtr& color,
                      const sensor_msgs::ImageConstPtr& depth, const pf::PinholeCamera& camera);

/// A copy of the pixels as a message.
sensor_msgs::ImagePtr toImage(const cv::Mat& pixels, const std::string& encoding,
                              const std_msgs::Header& header);

/// The depth of a frame as a message: 16UC1 where its unit is a millimetre, else 32FC1 metres.
sensor_msgs::ImagePtr toDepthImage(const pf::RgbdFrame& frame, const std_msgs::Header& header);

}  // namespace posefusion_ros
