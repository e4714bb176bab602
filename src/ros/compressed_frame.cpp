// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/compressed_frame.hpp"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "posefusion/core/error.hpp"
#include "posefusion_ros/bags/conversions.hpp"

namespace posefusion_ros {
namespace {

using pf::InputError;

constexpr double kMillimetre_m = 1e-3;
constexpr double kLeastUnit_m = 1e-6, kMostUnit_m = 1.0;

std::string sizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

std::string stampText(const ros::Time& stamp) {
  std::ostringstream text;
  text << stamp;
  return text.str();
}

/// The picture has pixels, and as many as its camera.
void checkSize(const std::string& what, const cv::Mat& pixels,
               const sensor_msgs::CameraInfo& info) {
  if (pixels.empty()) throw InputError(what + " image has no pixels");
  if (info.K[0] == 0.0 && info.P[0] == 0.0) {
    throw InputError(what + " comes with an empty camera_info, expected that of its camera");
  }
  pf::PinholeCamera camera;
  try {
    camera = toCamera(info, true);
  } catch (const InputError& error) {
    throw InputError("of " + what + ": " + error.what());
  }
  if (camera.width == pixels.cols && camera.height == pixels.rows) return;
  throw InputError(what + " is " + sizeText(pixels.cols, pixels.rows) + ", expected the " +
                   sizeText(camera.width, camera.height) + " of its camera_info");
}

void encode(const cv::Mat& pixels, const char* extension, const std::vector<int>& how,
            sensor_msgs::CompressedImage& out) {
  try {
    cv::imencode(extension, pixels, out.data, how);
  } catch (const cv::Exception& error) {
    throw InputError("an image of " + sizeText(pixels.cols, pixels.rows) +
                     " cannot be compressed: " + error.err);
  }
}

/// Run lengths alone: of what PNG offers the smallest of all that are quick (docs/robot.md).
void encodeDepth(const cv::Mat& steps, sensor_msgs::CompressedImage& out) {
  out.format = "16UC1; png compressed";
  encode(steps, ".png",
         {cv::IMWRITE_PNG_COMPRESSION, 1, cv::IMWRITE_PNG_STRATEGY, cv::IMWRITE_PNG_STRATEGY_RLE},
         out);
}

cv::Mat inSteps(const cv::Mat& metres) {
  cv::Mat steps(metres.size(), CV_16UC1);
  for (int v = 0; v < metres.rows; ++v) {
    const auto* in = metres.ptr<float>(v);
    std::transform(in, in + metres.cols, steps.ptr<std::uint16_t>(v), [](float z) {
      const double step = std::round(static_cast<double>(z) / kMetricDepthStep_m);
      return static_cast<std::uint16_t>(step > 0.0 && step <= 65535.0 ? step : 0.0);  // NaN too
    });
  }
  return steps;
}

void checkStamps(const CompressedFrameMsg& frame, double max_interval_s) {
  const ros::Time &color = frame.color.header.stamp, &depth = frame.depth.header.stamp;
  if (color != frame.header.stamp) {
    throw InputError("colour has the stamp " + stampText(color) + ", expected " +
                     stampText(frame.header.stamp) + ", that of the message");
  }
  // Not by ros::Duration: it throws beyond 68 years.
  if (std::abs(depth.toSec() - color.toSec()) <= max_interval_s + 1e-9) return;
  throw InputError("colour has the stamp " + stampText(color) + " and depth " + stampText(depth) +
                   ": they are of different frames, expected at most " +
                   std::to_string(max_interval_s) + " s between them");
}

/// One image of the message, which lives on with it.
sensor_msgs::CompressedImageConstPtr imageOf(const CompressedFrameMsg::ConstPtr& frame,
                                             const sensor_msgs::CompressedImage& image) {
  return {frame, &image};
}

sensor_msgs::CameraInfoPtr infoOf(const sensor_msgs::CameraInfo& info,
                                  const std_msgs::Header& header) {
  auto copy = boost::make_shared<sensor_msgs::CameraInfo>(info);
  copy->header = header;
  return copy;
}

}  // namespace

CompressedFrameMsg packFrame(const InputPairing::Set& set, double depth_unit_m, int jpeg_quality) {
  if (!set.info) throw InputError("no camera_info of colour");
  const cv::Mat color = toColor(set.color), depth = toDepth(set.depth);
  CompressedFrameMsg frame;
  frame.header = frame.color.header = set.color.header;
  frame.depth.header = set.depth.header;
  frame.depth.header.stamp = toTime(set.depth.stamp_ns);
  frame.camera_info = *set.info;
  checkSize("colour", color, frame.camera_info);
  if (!set.depth_info && depth.size() != color.size()) {
    throw InputError("depth is " + sizeText(depth.cols, depth.rows) + " and colour " +
                     sizeText(color.cols, color.rows) + ": expected a camera_info of depth");
  }
  frame.depth_camera_info = set.depth_info ? *set.depth_info : *set.info;
  checkSize("depth", depth, frame.depth_camera_info);
  cv::Mat bgr;
  cv::cvtColor(color, bgr, cv::COLOR_RGB2BGR);
  frame.color.format = "rgb8; jpeg compressed bgr8";
  encode(bgr, ".jpg", {cv::IMWRITE_JPEG_QUALITY, jpeg_quality}, frame.color);
  const bool metric = depth.type() == CV_32FC1;
  frame.depth_unit_m = metric ? kMetricDepthStep_m : depth_unit_m;
  encodeDepth(metric ? inSteps(depth) : depth, frame.depth);
  return frame;
}

UnpackedFrame unpackFrame(const CompressedFrameMsg::ConstPtr& frame, double max_interval_s) {
  checkStamps(*frame, max_interval_s);
  if (!(frame->depth_unit_m >= kLeastUnit_m && frame->depth_unit_m <= kMostUnit_m)) {
    throw InputError("depth_unit_m is " + std::to_string(frame->depth_unit_m) +
                     ", expected 0.000001 to 1");
  }
  pf::RgbdFrame pixels;
  pixels.color = toColor(imageOf(frame, frame->color));
  pixels.depth = toDepth(imageOf(frame, frame->depth));
  checkSize("colour", pixels.color, frame->camera_info);
  checkSize("depth", pixels.depth, frame->depth_camera_info);
  const bool millimetres = std::abs(frame->depth_unit_m - kMillimetre_m) < 1e-9;
  pixels.depth_unit_m = millimetres ? kMillimetre_m : frame->depth_unit_m;
  UnpackedFrame unpacked;
  unpacked.color = toImage(pixels.color, "rgb8", frame->header);
  unpacked.depth = toDepthImage(pixels, frame->depth.header);
  unpacked.info = infoOf(frame->camera_info, frame->header);
  unpacked.depth_info = infoOf(frame->depth_camera_info, frame->depth.header);
  return unpacked;
}

}  // namespace posefusion_ros
