// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rosbag/message_instance.h>

#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>

namespace posefusion_ros {

/// An image of a bag, not decoded yet.
struct BagImage {
  std::int64_t stamp_ns = 0;
  /// Its pixels, which live on their own. Throws InputError saying why there are none.
  std::function<cv::Mat()> decode;
};

/// Colour becomes CV_8UC3 R G B; depth CV_16UC1 millimetres or CV_32FC1 metres. Nothing when the
/// message is no image.
std::optional<BagImage> readColor(const rosbag::MessageInstance& message);
std::optional<BagImage> readDepth(const rosbag::MessageInstance& message);

}  // namespace posefusion_ros
