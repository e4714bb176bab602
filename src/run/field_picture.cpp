// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/run/field_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <string>

namespace pf {
namespace {

constexpr int kFieldWidth = 480, kFieldHeight = 360, kFieldMargin = 24, kTitle = 30, kBar = 20,
              kScale = 90;
constexpr double kAt_m = 2.0;

/// Blue for -1, white for 0, red for 1.
cv::Vec3b colorOf(double value) {
  const double x = std::clamp(value, -1.0, 1.0);
  const auto fade = [&](double to) {
    return static_cast<std::uint8_t>(std::lround(255.0 + std::abs(x) * (to - 255.0)));
  };
  return x > 0 ? cv::Vec3b(fade(190), fade(20), fade(30))
               : cv::Vec3b(fade(20), fade(60), fade(190));
}

/// What is measured is so much too far (m): z_measured - z_true.
double errorOf(const DepthField& field, double x, double y) {
  return kAt_m * kAt_m * field.at(x, y);
}

double largest(const DepthField& field) {
  double most = 0;
  for (int i = 0; i < 64 * 48; ++i) {
    most = std::max(most, std::abs(errorOf(field, (i % 64 + 0.5) / 64, (i / 64 + 0.5) / 48)));
  }
  return most;
}

void write(cv::Mat& picture, const std::string& text, const cv::Point& at) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(30, 30, 30), 1,
              cv::LINE_AA);
}

void drawField(const DepthField& field, const std::string& title, double scale, int left,
               cv::Mat& picture) {
  for (int v = 0; v < kFieldHeight; ++v) {
    for (int u = 0; u < kFieldWidth; ++u) {
      picture.at<cv::Vec3b>(kTitle + v, left + u) =
          colorOf(errorOf(field, (u + 0.5) / kFieldWidth, (v + 0.5) / kFieldHeight) / scale);
    }
  }
  write(picture, title, {left, kTitle - 10});
}

void drawBar(double scale, int left, cv::Mat& picture) {
  for (int v = 0; v < kFieldHeight; ++v) {
    const cv::Vec3b color = colorOf(1.0 - 2.0 * v / (kFieldHeight - 1));
    for (int u = 0; u < kBar; ++u) picture.at<cv::Vec3b>(kTitle + v, left + u) = color;
  }
  for (const double part : {1.0, 0.5, 0.0, -0.5, -1.0}) {
    char text[32];
    std::snprintf(text, sizeof text, "%+.1f mm", 1000.0 * scale * part);
    write(picture, text,
          {left + kBar + 4, kTitle + static_cast<int>((1 - part) / 2 * kFieldHeight) + 4});
  }
}

}  // namespace

cv::Mat drawFields(const DepthField& field, const std::optional<DepthField>& truth) {
  const double scale = std::max({1e-4, largest(field), truth ? largest(truth->centred()) : 0.0});
  const int pictures = truth ? 2 : 1;
  cv::Mat picture(kTitle + kFieldHeight + kFieldMargin,
                  pictures * (kFieldWidth + kFieldMargin) + kBar + kScale, CV_8UC3,
                  cv::Scalar::all(255));
  drawField(field, "measured depth at 2 m is too far by: estimate", scale, 0, picture);
  if (truth)
    drawField(truth->centred(), "truth (mean removed)", scale, kFieldWidth + kFieldMargin, picture);
  drawBar(scale, pictures * (kFieldWidth + kFieldMargin), picture);
  return picture;
}

}  // namespace pf
