// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CompressedImage.h>

#include <boost/make_shared.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "../temporary_folder.hpp"
#include "posefusion_ros/bags/conversions.hpp"

namespace posefusion_ros {

/// R G B as compressed_image_transport sends it, without loss.
inline sensor_msgs::CompressedImageConstPtr compressedColor(const cv::Mat& rgb,
                                                            const std_msgs::Header& header) {
  const auto message = boost::make_shared<sensor_msgs::CompressedImage>();
  message->header = header;
  message->format = "rgb8; png compressed bgr8";
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  cv::imencode(".png", bgr, message->data);
  return message;
}

/// 16-bit depth as a plain file (".png", ".tiff") in a message.
inline sensor_msgs::CompressedImageConstPtr plainDepth(const cv::Mat& depth,
                                                       const std_msgs::Header& header,
                                                       const std::string& extension) {
  const auto message = boost::make_shared<sensor_msgs::CompressedImage>();
  message->header = header;
  message->format = "16UC1; " + extension.substr(1) + " compressed";
  cv::imencode(extension, depth, message->data);
  return message;
}

/// 16-bit depth as compressed_depth_image_transport sends it.
inline sensor_msgs::CompressedImageConstPtr compressedDepth(const cv::Mat& depth,
                                                            const std_msgs::Header& header) {
  const auto message =
      boost::make_shared<sensor_msgs::CompressedImage>(*plainDepth(depth, header, ".png"));
  message->format = "16UC1; compressedDepth";
  message->data.insert(message->data.begin(), 12, 0);
  return message;
}

}  // namespace posefusion_ros
