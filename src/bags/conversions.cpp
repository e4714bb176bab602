// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/bags/conversions.hpp"

#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/error.hpp"

namespace posefusion_ros {

namespace enc = sensor_msgs::image_encodings;
using pf::InputError;

namespace {

/// The message's bytes as they are.
cv::Mat share(const sensor_msgs::ImageConstPtr& image) {
  if (!image || image->data.empty()) return {};
  try {
    return cv_bridge::toCvShare(image)->image;
  } catch (const cv_bridge::Exception& error) {
    throw InputError(std::string("image message: ") + error.what());
  }
}

/// Focal lengths and centre from K or P, in pixels of the full sensor.
void setIntrinsics(const sensor_msgs::CameraInfo& info, bool rectified, pf::PinholeCamera& camera) {
  const bool projection = rectified && info.P[0] > 0;
  camera.fx = projection ? info.P[0] : info.K[0];
  camera.cx = projection ? info.P[2] : info.K[2];
  camera.fy = projection ? info.P[5] : info.K[4];
  camera.cy = projection ? info.P[6] : info.K[5];
}

void setDistortion(const sensor_msgs::CameraInfo& info, pf::PinholeCamera& camera) {
  // All zero means rectified, whatever the model, as image_geometry takes it.
  const auto is_used = [](double d) { return d != 0.0; };
  if (std::none_of(info.D.begin(), info.D.end(), is_used)) return;
  const auto lens = info.distortion_model.empty() ? pf::LensModel::kPolynomial
                                                  : pf::lensModelNamed(info.distortion_model);
  const std::size_t known = lens == pf::LensModel::kEquidistant ? 4 : camera.distortion.size();
  if (!lens ||
      (info.D.size() > known && std::any_of(info.D.begin() + known, info.D.end(), is_used))) {
    throw InputError("camera_info: distortion model '" + info.distortion_model + "' with " +
                     std::to_string(info.D.size()) +
                     " coefficients, expected plumb_bob with 5, rational_polynomial with 8 or "
                     "equidistant with 4 (rectify others with image_proc)");
  }
  camera.lens = *lens;
  std::copy_n(info.D.begin(), std::min(known, info.D.size()), camera.distortion.begin());
}

/// A colour encoding that is converted.
struct ColorEncoding {
  const char* name;
  int type;
  int to_rgb;  ///< conversion of OpenCV, which names a Bayer pattern by the pixels (1, 1), (1, 2)
};

constexpr int kNoConversion = -1;
constexpr std::array<ColorEncoding, 11> kColorEncodings = {{
    {"rgb8", CV_8UC3, kNoConversion},
    {"bgr8", CV_8UC3, cv::COLOR_BGR2RGB},
    {"rgba8", CV_8UC4, cv::COLOR_RGBA2RGB},
    {"bgra8", CV_8UC4, cv::COLOR_BGRA2RGB},
    {"mono8", CV_8UC1, cv::COLOR_GRAY2RGB},
    {"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2RGB},
    {"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2RGB},
    {"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2RGB},
    {"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2RGB},
    {"yuv422", CV_8UC2, cv::COLOR_YUV2RGB_UYVY},
    {"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2RGB_YUYV},
}};

const ColorEncoding& encodingOf(const sensor_msgs::Image& image) {
  std::string known;
  for (const auto& encoding : kColorEncodings) {
    if (image.encoding == encoding.name) return encoding;
    known += (known.empty() ? "" : ", ") + std::string(encoding.name);
  }
  throw InputError("colour image: encoding '" + image.encoding + "', expected " + known);
}

}  // namespace

// Not by cv_bridge: it knows neither yuv422_yuy2 nor every Bayer pattern in all its versions.
cv::Mat toColor(const sensor_msgs::ImageConstPtr& image) {
  if (!image || image->data.empty() || image->width == 0 || image->height == 0) return {};
  const ColorEncoding& encoding = encodingOf(*image);
  const std::size_t row = std::size_t{image->width} * CV_ELEM_SIZE(encoding.type);
  if (image->step < row || image->data.size() < image->step * std::size_t{image->height}) {
    throw InputError("image message: " + std::to_string(image->width) + "x" +
                     std::to_string(image->height) + " of " + image->encoding + " with rows of " +
                     std::to_string(image->step) + " bytes and " +
                     std::to_string(image->data.size()) + " in all, expected more");
  }
  const cv::Mat pixels(static_cast<int>(image->height), static_cast<int>(image->width),
                       encoding.type, const_cast<std::uint8_t*>(image->data.data()), image->step);
  if (encoding.to_rgb == kNoConversion) return pixels;
  cv::Mat rgb;
  try {
    cv::cvtColor(pixels, rgb, encoding.to_rgb);
  } catch (const cv::Exception& error) {
    throw InputError("colour image: " + std::to_string(image->width) + "x" +
                     std::to_string(image->height) + " of " + image->encoding +
                     " cannot be converted: " + error.err);
  }
  return rgb;
}

cv::Mat toDepth(const sensor_msgs::ImageConstPtr& image) {
  const cv::Mat pixels = share(image);
  if (pixels.empty() || image->encoding == enc::TYPE_16UC1 || image->encoding == enc::MONO16 ||
      image->encoding == enc::TYPE_32FC1) {
    return pixels;
  }
  throw InputError("depth image: encoding '" + image->encoding +
                   "', expected 16UC1 (millimetres) or 32FC1 (metres)");
}

pf::PinholeCamera toCamera(const sensor_msgs::CameraInfo& info, bool rectified) {
  pf::PinholeCamera camera;
  setIntrinsics(info, rectified, camera);
  const int bin_x = std::max(1, static_cast<int>(info.binning_x));
  const int bin_y = std::max(1, static_cast<int>(info.binning_y));
  const bool full = info.roi.width == 0 || info.roi.height == 0;
  camera.width = static_cast<int>(full ? info.width : info.roi.width) / bin_x;
  camera.height = static_cast<int>(full ? info.height : info.roi.height) / bin_y;
  camera.fx /= bin_x;
  camera.fy /= bin_y;
  camera.cx = (camera.cx - info.roi.x_offset) / bin_x;
  camera.cy = (camera.cy - info.roi.y_offset) / bin_y;
  if (!rectified) setDistortion(info, camera);
  try {
    pf::validate(camera);
  } catch (const InputError& error) {
    throw InputError(std::string("camera_info: ") + error.what());
  }
  return camera;
}

sensor_msgs::CameraInfo toCameraInfo(const pf::PinholeCamera& camera,
                                     const std_msgs::Header& header) {
  sensor_msgs::CameraInfo info;
  info.header = header;
  info.width = camera.width;
  info.height = camera.height;
  info.distortion_model = camera.lensName();
  info.D.assign(camera.distortion.begin(), camera.distortion.begin() + camera.lensCoefficients());
  info.K = {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {camera.fx, 0, camera.cx, 0, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0};
  return info;
}

pf::RgbdFrame toFrame(const sensor_msgs::ImageConstPtr& color,
                      const sensor_msgs::ImageConstPtr& depth, const pf::PinholeCamera& camera) {
  pf::RgbdFrame frame;
  frame.stamp_ns = toNs(color->header.stamp);
  frame.color = toColor(color);
  frame.depth = toDepth(depth);
  frame.camera = camera;
  const std::string defect = pf::defectOf(frame);
  if (!defect.empty()) throw InputError(defect);
  return frame;
}

sensor_msgs::ImagePtr toImage(const cv::Mat& pixels, const std::string& encoding,
                              const std_msgs::Header& header) {
  return cv_bridge::CvImage(header, encoding, pixels).toImageMsg();
}

sensor_msgs::ImagePtr toDepthImage(const pf::RgbdFrame& frame, const std_msgs::Header& header) {
  if (frame.depth.type() == CV_32FC1) return toImage(frame.depth, enc::TYPE_32FC1, header);
  if (frame.depth_unit_m == 1e-3) return toImage(frame.depth, enc::TYPE_16UC1, header);
  // Multiplied as depthInMetres() does it, so that a replay sees the same numbers.
  cv::Mat metres(frame.depth.size(), CV_32FC1);
  const auto unit = static_cast<float>(frame.depth_unit_m);
  for (int v = 0; v < metres.rows; ++v) {
    const auto* in = frame.depth.ptr<std::uint16_t>(v);
    std::transform(in, in + metres.cols, metres.ptr<float>(v),
                   [unit](std::uint16_t z) { return static_cast<float>(z) * unit; });
  }
  return toImage(metres, enc::TYPE_32FC1, header);
}

}  // namespace posefusion_ros
