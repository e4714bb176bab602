// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/contact_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace pf::simulator {
namespace {

cv::Scalar personColor(int id) {
  static const cv::Scalar colors[] = {{255, 80, 60},  {70, 200, 90},  {80, 130, 255},
                                      {250, 210, 60}, {220, 90, 230}, {70, 220, 220}};
  return colors[(id - 1) % 6];
}

cv::Mat maskColors(const cv::Mat& mask, const cv::Mat& color) {
  cv::Mat grey, out;
  cv::cvtColor(color, grey, cv::COLOR_RGB2GRAY);
  cv::cvtColor(grey * 0.5, out, cv::COLOR_GRAY2RGB);
  for (int row = 0; row < mask.rows; ++row) {
    for (int col = 0; col < mask.cols; ++col) {
      const int id = mask.at<std::uint8_t>(row, col);
      if (id == 0) continue;
      const cv::Scalar c = personColor(id);
      auto& p = out.at<cv::Vec3b>(row, col);
      for (int k = 0; k < 3; ++k) p[k] = cv::saturate_cast<std::uint8_t>(0.5 * p[k] + 0.6 * c[k]);
    }
  }
  return out;
}

}  // namespace

cv::Mat depthColors(const cv::Mat& depth_mm) {
  cv::Mat out(depth_mm.size(), CV_8UC3);
  for (int row = 0; row < out.rows; ++row) {
    for (int col = 0; col < out.cols; ++col) {
      const float z = static_cast<float>(depth_mm.at<std::uint16_t>(row, col)) / 5000.0F;
      const auto hump = [&](float centre) {
        return cv::saturate_cast<std::uint8_t>(255.0F * (1.5F - 4.0F * std::abs(z - centre)));
      };
      out.at<cv::Vec3b>(row, col) =
          z > 0.0F ? cv::Vec3b(hump(0.20F), hump(0.48F), hump(0.78F)) : cv::Vec3b(0, 0, 0);
    }
  }
  return out;
}

void drawJoints(const std::vector<PersonTruth>& people, cv::Mat& picture) {
  const auto pixel = [](const Eigen::Vector2d& p) {
    return cv::Point(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
  };
  for (const PersonTruth& person : people) {
    const cv::Scalar color = personColor(person.id);
    for (const auto& [from, to] : kSkeletonLines) {
      const auto a = static_cast<std::size_t>(from), b = static_cast<std::size_t>(to);
      if (!person.in_view[a] || !person.in_view[b]) continue;
      const bool seen = person.visible[a] && person.visible[b];
      cv::line(picture, pixel(person.joints_px[a]), pixel(person.joints_px[b]), color, seen ? 3 : 1,
               cv::LINE_AA);
    }
    for (std::size_t j = 0; j < person.joints_px.size(); ++j) {
      if (person.in_view[j]) {
        cv::circle(picture, pixel(person.joints_px[j]), 4, color, person.visible[j] ? -1 : 1,
                   cv::LINE_AA);
      }
    }
  }
}

cv::Mat drawFrame(const SimulatedFrame& frame, const Simulation& simulation, int width) {
  const int height = width * frame.frame.color.rows / frame.frame.color.cols;
  cv::Mat joints = frame.frame.color.clone();
  drawJoints(frame.people, joints);
  const cv::Mat parts[] = {frame.frame.color, depthColors(frame.frame.depth),
                           maskColors(frame.mask, frame.frame.color), joints};
  cv::Mat row(height, 4 * width, CV_8UC3);
  for (int i = 0; i < 4; ++i) {
    cv::resize(parts[i], row(cv::Rect(i * width, 0, width, height)), {width, height}, 0, 0,
               i == 1 ? cv::INTER_NEAREST : cv::INTER_AREA);
  }
  char text[120];
  std::snprintf(text, sizeof text, "%s %d  %.2f s  %.1f ms x%.1f  smear %.1f px",
                simulation.scenario().name.c_str(), frame.index,
                (frame.frame.stamp_ns - simulation.stampOf(0.0)) * 1e-9, frame.exposure.time_ms,
                frame.exposure.gain, frame.smear_px);
  cv::putText(row, text, {6, height - 8}, cv::FONT_HERSHEY_SIMPLEX, 0.4, {0, 0, 0}, 3, cv::LINE_AA);
  cv::putText(row, text, {6, height - 8}, cv::FONT_HERSHEY_SIMPLEX, 0.4, {255, 255, 255}, 1,
              cv::LINE_AA);
  return row;
}

}  // namespace pf::simulator
