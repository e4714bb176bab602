// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/frame.hpp"

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

std::string sizeText(const cv::Size& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

template <typename Pixel>
void convertRow(const Pixel* in, float* out, int width, float unit, float low, float high) {
  for (int u = 0; u < width; ++u) {
    const float z = static_cast<float>(in[u]) * unit;
    out[u] = z >= low && z <= high ? z : 0.0F;  // NaN compares false
  }
}

/// Where the pixels of the rectified image are in the image of `camera`.
void makeMaps(const PinholeCamera& camera, cv::Mat& map1, cv::Mat& map2) {
  const cv::Mat K =
      (cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const cv::Size size(camera.width, camera.height);
  const auto& d = camera.distortion;
  if (camera.lens == LensModel::kEquidistant) {
    cv::fisheye::initUndistortRectifyMap(K, std::vector<double>(d.begin(), d.begin() + 4),
                                         cv::Mat(), K, size, CV_32FC1, map1, map2);
    return;
  }
  cv::initUndistortRectifyMap(K, std::vector<double>(d.begin(), d.end()), cv::Mat(), K, size,
                              CV_32FC1, map1, map2);
}

}  // namespace

std::string defectOf(const RgbdFrame& frame) {
  if (frame.color.empty()) return "there is no colour image";
  if (frame.depth.empty()) return "there is no depth image";
  if (frame.color.type() != CV_8UC3) return "the colour image is not 8-bit with three channels";
  if (frame.depth.type() != CV_16UC1 && frame.depth.type() != CV_32FC1) {
    return "the depth image is neither 16-bit unsigned nor 32-bit float with one channel";
  }
  if (frame.color.size() != frame.depth.size()) {
    return "colour is " + sizeText(frame.color.size()) + " but depth is " +
           sizeText(frame.depth.size()) + ", expected registered images of one size";
  }
  const cv::Size expected(frame.camera.width, frame.camera.height);
  if (frame.color.size() != expected) {
    return "the images are " + sizeText(frame.color.size()) + " but the camera is " +
           sizeText(expected);
  }
  return {};
}

void depthInMetres(const RgbdFrame& frame, double min_depth_m, double max_depth_m,
                   cv::Mat& depth_m) {
  depth_m.create(frame.depth.size(), CV_32FC1);
  const int width = frame.depth.cols;
  const auto low = static_cast<float>(min_depth_m);
  const auto high = static_cast<float>(max_depth_m);
  const auto unit = static_cast<float>(frame.depth_unit_m);
  const bool integer = frame.depth.type() == CV_16UC1;
  parallelFor(depth_m.rows, 32, [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
      if (integer) {
        convertRow(frame.depth.ptr<std::uint16_t>(v), depth_m.ptr<float>(v), width, unit, low,
                   high);
      } else {
        convertRow(frame.depth.ptr<float>(v), depth_m.ptr<float>(v), width, 1.0F, low, high);
      }
    }
  });
}

RgbdFrame Rectifier::rectify(const RgbdFrame& frame) {
  if (!frame.camera.isDistorted()) return frame;
  if (map1_.empty() || camera_ != frame.camera) {
    camera_ = frame.camera;
    makeMaps(camera_, map1_, map2_);
  }
  RgbdFrame out = frame;
  out.color = cv::Mat();
  out.depth = cv::Mat();
  out.camera = frame.camera.withoutDistortion();
  cv::remap(frame.color, out.color, map1_, map2_, cv::INTER_LINEAR);
  cv::remap(frame.depth, out.depth, map1_, map2_, cv::INTER_NEAREST);
  return out;
}

}  // namespace pf
