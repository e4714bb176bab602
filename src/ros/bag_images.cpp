// SPDX-License-Identifier: BSD-3-Clause
#include "bag_images.hpp"

#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <cstring>
#include <limits>

#include "posefusion/core/error.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion_ros/conversions.hpp"

namespace posefusion_ros {
namespace {

using pf::InputError;
using sensor_msgs::CompressedImage;
using sensor_msgs::Image;

cv::Mat decodeColorMessage(const CompressedImage& message) {
  cv::Mat pixels = pf::decodeColor(message.data.data(), message.data.size());
  if (pixels.empty()) {
    throw InputError("a compressed colour image ('" + message.format + "') is not a whole image");
  }
  return pixels;
}

/// What compressed_depth_image_transport puts before the PNG.
struct DepthHeader {
  std::int32_t format;
  float quantisation_a;
  float quantisation_b;
};
static_assert(sizeof(DepthHeader) == 12, "as on the wire");

/// Inverse depth in 16 bits back to metres.
cv::Mat toMetres(const cv::Mat& stored, const DepthHeader& header) {
  cv::Mat metres(stored.size(), CV_32FC1);
  for (int v = 0; v < stored.rows; ++v) {
    for (int u = 0; u < stored.cols; ++u) {
      const std::uint16_t raw = stored.at<std::uint16_t>(v, u);
      metres.at<float>(v, u) =
          raw == 0 ? std::numeric_limits<float>::quiet_NaN()
                   : header.quantisation_a / (static_cast<float>(raw) - header.quantisation_b);
    }
  }
  return metres;
}

cv::Mat decodeDepthMessage(const CompressedImage& message) {
  // "16UC1; compressedDepth", "32FC1; compressedDepth png", or plain PNG: "16UC1; png compressed".
  const bool has_header = message.format.find("compressedDepth") != std::string::npos;
  const std::size_t offset = has_header ? sizeof(DepthHeader) : 0;
  if (message.format.find("rvl") != std::string::npos) {
    throw InputError("depth image: format '" + message.format + "', expected PNG");
  }
  if (message.data.size() <= offset) throw InputError("a compressed depth image has no pixels");
  const cv::Mat stored =
      pf::decodeDepth(message.data.data() + offset, message.data.size() - offset);
  if (stored.empty() || stored.type() != CV_16UC1) {
    throw InputError("a compressed depth image ('" + message.format +
                     "') is not a whole 16-bit PNG");
  }
  if (message.format.find("32FC1") == std::string::npos) return stored;
  DepthHeader header{};
  std::memcpy(&header, message.data.data(), offset);
  return toMetres(stored, header);
}

/// Reads an Image or a CompressedImage, to be decoded by `raw` or `compressed`.
template <typename Raw, typename Compressed>
std::optional<BagImage> readImage(const rosbag::MessageInstance& message, const Raw& raw,
                                  const Compressed& compressed) {
  if (const auto image = message.instantiate<Image>()) {
    // The pixels are copied: they outlive the message.
    return BagImage{toNs(image->header.stamp), [image, raw] { return raw(image).clone(); }};
  }
  if (const auto image = message.instantiate<CompressedImage>()) {
    return BagImage{toNs(image->header.stamp), [image, compressed] { return compressed(*image); }};
  }
  return std::nullopt;
}

}  // namespace

std::optional<BagImage> readColor(const rosbag::MessageInstance& message) {
  return readImage(message, toColor, decodeColorMessage);
}

std::optional<BagImage> readDepth(const rosbag::MessageInstance& message) {
  return readImage(message, toDepth, decodeDepthMessage);
}

}  // namespace posefusion_ros
