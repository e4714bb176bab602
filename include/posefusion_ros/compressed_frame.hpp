// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include "posefusion_ros/bags/messages.hpp"
#include "posefusion_ros/input_pairing.hpp"

namespace posefusion_ros {

/// Step in which depth in metres (32FC1) is sent: it reaches 16.4 m, and is finer than any depth
/// camera measures. Depth beyond it is sent as not measured.
constexpr double kMetricDepthStep_m = 0.00025;

/// A frame of the camera as one compressed message: colour as JPEG of `jpeg_quality` (1 to 100),
/// 16-bit depth of `depth_unit_m` as PNG without loss, depth in metres (32FC1) rounded to
/// kMetricDepthStep_m. Throws InputError naming what does not fit: an image that cannot be read,
/// a size that is not that of its camera_info, a camera_info that is missing.
CompressedFrameMsg packFrame(const InputPairing::Set& set, double depth_unit_m, int jpeg_quality);

/// The messages of a camera. All are of the frame of colour but depth, which keeps its own.
struct UnpackedFrame {
  sensor_msgs::ImagePtr color;  ///< rgb8
  sensor_msgs::ImagePtr depth;  ///< 16UC1 where a step is a millimetre, else 32FC1 in metres
  sensor_msgs::CameraInfoPtr info, depth_info;
};

/// Throws InputError as above, and where the images are not of one frame: the stamp of colour is
/// that of the message, and depth may differ from it by `max_interval_s`.
UnpackedFrame unpackFrame(const CompressedFrameMsg::ConstPtr& frame, double max_interval_s);

}  // namespace posefusion_ros
