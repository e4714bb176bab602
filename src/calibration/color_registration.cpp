// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/color_registration.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr double kNearest_m = 0.1, kAnyDepth_m = 1e3;
constexpr double kHidden = 0.5;  // of a pixel of depth, behind the edge of something nearer

/// Inverse depth (1/m) from depth (m); a gap has the smaller of those at its ends.
void fillRow(const float* depth_m, int width, float* inverse) {
  float left = 0;
  for (int u = 0; u < width; ++u) {
    if (depth_m[u] > 0) {
      inverse[u] = left = 1.0F / depth_m[u];
      continue;
    }
    int end = u;
    while (end < width && depth_m[end] <= 0) ++end;
    const float right = end < width ? 1.0F / depth_m[end] : left;
    const float filled = left > 0 ? std::min(left, right) : right;
    std::fill(inverse + u, inverse + end, filled);
    u = end - 1;
  }
}

/// A single pixel of wrong depth would hide what is beside it: the median of three (1/m).
void takeOutSpeckles(int width, float* inverse) {
  float before = inverse[0];
  for (int u = 1; u + 1 < width; ++u) {
    const float here = inverse[u], after = inverse[u + 1];
    inverse[u] = std::max(std::min(before, here), std::min(std::max(before, here), after));
    before = here;
  }
}

/// `x`: where the pixels of a row are seen in the colour image, by place. Nearer things are shifted
/// to one side and hide what lies there: it takes the place beside them.
void clearHidden(double zoom, double shift_px_m, int width, float* x) {
  if (shift_px_m == 0) return;
  const bool to_left = shift_px_m < 0;
  const int step = to_left ? -1 : 1;
  float edge = to_left ? x[width - 1] : x[0];
  for (int u = to_left ? width - 2 : 1; u >= 0 && u < width; u += step) {
    const float behind = to_left ? x[u] - edge : edge - x[u];
    if (behind > static_cast<float>(-kHidden * zoom)) {
      x[u] = edge + static_cast<float>(step);
    } else {
      edge = x[u];
    }
  }
}

}  // namespace

RgbdFrame ColorRegistration::registered(const RgbdFrame& frame) {
  depthInMetres(frame, kNearest_m, kAnyDepth_m, depth_m_);
  x_.create(depth_m_.size(), CV_32FC1);
  y_.create(depth_m_.size(), CV_32FC1);
  const PinholeCamera& depth = frame.camera;
  const auto zoom = static_cast<float>(camera_.fx / depth.fx);
  const auto from = static_cast<float>(camera_.cx - camera_.fx / depth.fx * depth.cx);
  const auto shift_px_m = static_cast<float>(camera_.fx * camera_.depth_right_m);
  parallelFor(static_cast<std::size_t>(depth_m_.rows), kRowsAtOnce,
              [&](std::size_t begin, std::size_t end) {
                for (auto v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
                  auto* x = x_.ptr<float>(v);
                  fillRow(depth_m_.ptr<float>(v), x_.cols, x);
                  takeOutSpeckles(x_.cols, x);
                  for (int u = 0; u < x_.cols; ++u) {
                    x[u] = from + zoom * static_cast<float>(u) + shift_px_m * x[u];
                  }
                  clearHidden(zoom, shift_px_m, x_.cols, x);
                  y_.row(v).setTo(camera_.pixel(depth, 0, v, 0).y());
                }
              });
  RgbdFrame out = frame;
  out.color = cv::Mat();
  cv::remap(frame.color, out.color, x_, y_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return out;
}

}  // namespace pf
