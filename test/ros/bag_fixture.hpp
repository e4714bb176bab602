// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/image_encodings.h>

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "../temporary_folder.hpp"
#include "message_parts.hpp"
#include "posefusion_ros/bags/bag_source.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/bags/stage_messages.hpp"

namespace posefusion_ros {

namespace enc = sensor_msgs::image_encodings;
using pf::errorOf;
using pf::SourceFrame;

inline constexpr std::int64_t kMs = 1'000'000;

inline pf::PinholeCamera camera() {
  pf::PinholeCamera c;
  c.width = 64;
  c.height = 48;
  c.fx = c.fy = 60;
  c.cx = 31.5;
  c.cy = 23.5;
  return c;
}

inline cv::Mat colorAt(std::int64_t stamp_ns) {
  cv::Mat image(48, 64, CV_8UC3);
  cv::RNG(static_cast<std::uint64_t>(stamp_ns)).fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

inline cv::Mat depthAt(std::int64_t stamp_ns) {
  cv::Mat image(48, 64, CV_16UC1);
  cv::RNG(static_cast<std::uint64_t>(stamp_ns) + 1).fill(image, cv::RNG::UNIFORM, 500, 4000);
  return image;
}

/// Writes messages 1 ms apart in recording time, whatever their stamps.
class BagFile {
 public:
  explicit BagFile(const std::string& path) : bag_(path, rosbag::bagmode::Write) {}

  template <typename Message>
  void write(const std::string& topic, const Message& message) {
    now_ns_ += kMs;
    bag_.write(topic, toTime(now_ns_), message);
  }
  void color(std::int64_t stamp_ns, const std::string& topic = "/camera/rgb/image_color") {
    write(topic, *toImage(colorAt(stamp_ns), enc::RGB8, headerAt(stamp_ns, "camera")));
  }
  void depth(std::int64_t stamp_ns, const std::string& topic = "/camera/depth_registered/image") {
    write(topic, *toImage(depthAt(stamp_ns), enc::TYPE_16UC1, headerAt(stamp_ns, "camera")));
  }
  void info(const std::string& topic = "/camera/rgb/camera_info") {
    write(topic, toCameraInfo(camera(), headerAt(now_ns_, "camera")));
  }
  void close() { bag_.close(); }

 private:
  rosbag::Bag bag_;
  std::int64_t now_ns_ = 1'000'000'000;
};

inline std::vector<SourceFrame> readAll(pf::FrameSource& source) {
  std::vector<SourceFrame> frames;
  while (auto frame = source.next()) frames.push_back(*frame);
  return frames;
}

class BagSourceTest : public testing::Test {
 protected:
  std::string path() const { return folder / "x.bag"; }
  std::string openError(const InputOptions& options = {}) const {
    return errorOf([&] { openInput(path(), options); });
  }
  static bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }
  pf::TemporaryFolder folder;
};

}  // namespace posefusion_ros
