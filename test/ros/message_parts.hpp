// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <std_msgs/Header.h>

#include <opencv2/core.hpp>
#include <string>

#include "posefusion_ros/bags/conversions.hpp"

namespace posefusion_ros {

inline std_msgs::Header headerAt(std::int64_t stamp_ns, const std::string& frame = "optical") {
  std_msgs::Header header;
  header.stamp = toTime(stamp_ns);
  header.frame_id = frame;
  return header;
}

inline bool samePixels(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

}  // namespace posefusion_ros
