// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/one_size.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "posefusion/core/error.hpp"

namespace pf {
namespace {

/// How different the scales of columns and rows may be: calibrations differ by less.
constexpr double kShapeTolerance = 0.02;

std::string textOf(const PinholeCamera& c) {
  std::ostringstream text;
  text << c.width << "x" << c.height << " (fx " << c.fx << " fy " << c.fy << " cx " << c.cx
       << " cy " << c.cy << ", " << c.lensName() << ")";
  return text.str();
}

[[noreturn]] void refuse(const PinholeCamera& color, const PinholeCamera& depth,
                         const std::string& why) {
  throw InputError("colour is " + textOf(color) + " but depth is " + textOf(depth) + ": " + why);
}

void checkSize(const cv::Mat& image, const PinholeCamera& camera, const char* which) {
  if (image.cols == camera.width && image.rows == camera.height) return;
  throw InputError(std::string("the ") + which + " image is " + std::to_string(image.cols) + "x" +
                   std::to_string(image.rows) + " but its camera is " +
                   std::to_string(camera.width) + "x" + std::to_string(camera.height));
}

/// A span of pixels of the large image.
struct Span {
  int begin = 0;
  int length = 0;
  bool is_inside = false;
};

/// Where the pixels [0, small) lie along an axis of the large image. A pixel has its centre at its
/// integer, its edges half a pixel beside it. What sticks out by no more than one small pixel comes
/// from another convention for the centre of a scaled image, and is moved inside.
Span spanOf(double scale, double small_centre, int small, double large_centre, int large) {
  Span span;
  const auto begin = std::lround((-0.5 - small_centre) * scale + large_centre + 0.5);
  span.length = std::min(static_cast<int>(std::lround(small * scale)), large);
  span.begin = std::clamp(static_cast<int>(begin), 0, large - span.length);
  span.is_inside = std::abs(static_cast<double>(begin) - span.begin) <= std::max(1.0, scale) &&
                   small * scale <= large + std::max(1.0, scale);
  return span;
}

}  // namespace

RgbdFrame bringToOneSize(const RgbdFrame& frame, const PinholeCamera& depth_camera) {
  const PinholeCamera& color_camera = frame.camera;
  checkSize(frame.color, color_camera, "colour");
  checkSize(frame.depth, depth_camera, "depth");
  if (frame.color.size() == frame.depth.size()) return frame;
  if (color_camera.lens != depth_camera.lens ||
      color_camera.distortion != depth_camera.distortion) {
    refuse(color_camera, depth_camera, "expected the same distortion (depth registered to colour)");
  }
  const bool shrink_color = frame.color.total() > frame.depth.total();
  const PinholeCamera& small = shrink_color ? depth_camera : color_camera;
  const PinholeCamera& large = shrink_color ? color_camera : depth_camera;
  const double scale_x = large.fx / small.fx, scale_y = large.fy / small.fy;
  if (std::abs(scale_x / scale_y - 1) > kShapeTolerance) {
    refuse(color_camera, depth_camera, "expected one scale for columns and rows");
  }
  const Span x = spanOf(scale_x, small.cx, small.width, large.cx, large.width);
  const Span y = spanOf(scale_y, small.cy, small.height, large.cy, large.height);
  if (!x.is_inside || !y.is_inside) {
    refuse(color_camera, depth_camera, "expected the larger image to see all of the smaller");
  }
  const cv::Rect seen(x.begin, y.begin, x.length, y.length);
  RgbdFrame out = frame;
  out.camera = small;
  cv::Mat& scaled = shrink_color ? out.color : out.depth;
  const cv::Mat full = scaled(seen);
  scaled = cv::Mat();
  cv::resize(full, scaled, {small.width, small.height}, 0, 0,
             shrink_color ? cv::INTER_AREA : cv::INTER_NEAREST);
  return out;
}

}  // namespace pf
