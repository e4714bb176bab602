// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstring>
#include <limits>

#include "posefusion/core/error.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion_ros/bags/conversions.hpp"

namespace posefusion_ros {
namespace {

using pf::InputError;
using sensor_msgs::CompressedImage;

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

bool isPng(const std::vector<std::uint8_t>& data, std::size_t offset) {
  constexpr std::array<std::uint8_t, 4> kSignature = {0x89, 'P', 'N', 'G'};
  return data.size() >= offset + kSignature.size() &&
         std::equal(kSignature.begin(), kSignature.end(), data.begin() + offset);
}

[[noreturn]] void refuse(const CompressedImage& message, const std::string& what) {
  throw InputError("a compressed " + what + " (format '" + message.format + "', " +
                   std::to_string(message.data.size()) + " bytes)");
}

}  // namespace

cv::Mat toColor(const sensor_msgs::CompressedImageConstPtr& image) {
  cv::Mat pixels = pf::decodeColor(image->data.data(), image->data.size());
  if (pixels.empty()) refuse(*image, "colour image is not whole, expected JPEG or PNG");
  return pixels;
}

// "16UC1; compressedDepth" and "32FC1; compressedDepth png" have the header, "16UC1; png
// compressed" and "16UC1; tiff compressed" have none. The signature of PNG shows where it begins.
cv::Mat toDepth(const sensor_msgs::CompressedImageConstPtr& image) {
  const auto& data = image->data;
  if (data.empty()) refuse(*image, "depth image has no pixels");
  const std::size_t offset = isPng(data, sizeof(DepthHeader)) ? sizeof(DepthHeader) : 0;
  const cv::Mat stored = pf::decodeDepth(data.data() + offset, data.size() - offset);
  if (stored.empty() || stored.type() != CV_16UC1) {
    refuse(*image,
           "depth image is not a whole 16-bit PNG or TIFF, nor such a PNG after the header "
           "of compressedDepth (RVL is not read)");
  }
  if (image->format.find("32FC1") == std::string::npos) return stored;
  if (offset == 0) refuse(*image, "depth image of 32FC1 lacks the header of compressedDepth");
  DepthHeader header{};
  std::memcpy(&header, data.data(), offset);
  return toMetres(stored, header);
}

}  // namespace posefusion_ros
