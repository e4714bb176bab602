// SPDX-License-Identifier: BSD-3-Clause
#include "plan_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pf {
namespace {

constexpr float kSplat_m = 0.012F;  // half the side of a point of the surface
constexpr float kWall_m = 1.0F;     // upright surface higher than this above the lowest is wall
const cv::Vec3b kWallColor(142, 146, 152);

/// Squares of 2 half + 1 pixels; the highest of each pixel is seen, over what the picture shows.
template <typename Splat>
void drawSplats(const std::vector<Splat>& splats, int half, bool walls, cv::Mat& picture) {
  cv::Mat height(picture.size(), CV_32FC1, cv::Scalar(-std::numeric_limits<float>::max()));
  for (const Splat& splat : splats) {
    if (splat.wall && !walls) continue;
    const cv::Point corner = splat.at - cv::Point(half, half);
    const cv::Rect inside =
        cv::Rect(corner, cv::Size(2 * half + 1, 2 * half + 1)) & cv::Rect({0, 0}, picture.size());
    for (int y = inside.y; y < inside.br().y; ++y) {
      for (int x = inside.x; x < inside.br().x; ++x) {
        if (splat.height <= height.at<float>(y, x)) continue;
        height.at<float>(y, x) = splat.height;
        picture.at<cv::Vec3b>(y, x) = splat.color;
      }
    }
  }
}

}  // namespace

/// A point of the surface in the picture.
struct PlanView::Splat {
  cv::Point at;
  float height = 0;
  cv::Vec3b color;
  bool wall = false;
};

void PlanView::Range::extend(std::vector<double> values, double cut) {
  if (values.empty()) return;
  std::sort(values.begin(), values.end());
  const auto skip = static_cast<std::size_t>(cut * static_cast<double>(values.size()));
  low = std::min(low, values[skip]);
  high = std::max(high, values[values.size() - 1 - skip]);
}

PlanView::PlanView(const Plan& plan) : up_(upOf(plan.leading())) {
  // Axes of the picture: those of the frame where they lie level.
  right_ = std::abs(up_.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  right_ = (right_ - right_.dot(up_) * up_).normalized();
  ahead_ = up_.cross(right_);
  measure(plan);
  if (v_.size() > u_.size()) {  // the long side lies across
    std::swap(right_, ahead_);
    right_ = -right_;
    measure(plan);
  }
  const double across = kWidth - 2 * kMargin, along = kTallest - 2 * kMargin;
  scale_ = std::min(across / std::max(0.5, u_.size()), along / std::max(0.5, v_.size()));
  shift_ = 0.5 * (across - scale_ * u_.size());
}

cv::Point2d PlanView::at(const Eigen::Vector3d& point) const {
  return {kMargin + shift_ + scale_ * (right_.dot(point) - u_.low),
          kMargin + scale_ * (v_.high - ahead_.dot(point))};
}

void PlanView::measure(const Plan& plan) {
  std::vector<double> u, v, path_u, path_v;
  for (const auto& point : plan.surface) {
    u.push_back(right_.dot(point.position.cast<double>()));
    v.push_back(ahead_.dot(point.position.cast<double>()));
  }
  for (const auto* path : {&plan.truth, &plan.estimate}) {
    for (const auto& pose : *path) {
      path_u.push_back(right_.dot(pose.T_world_camera.translation()));
      path_v.push_back(ahead_.dot(pose.T_world_camera.translation()));
    }
  }
  u_ = {path_u.front(), path_u.front()};
  v_ = {path_v.front(), path_v.front()};
  u_.extend(u, 0.002);
  v_.extend(v, 0.002);
  u_.extend(path_u, 0.0);
  v_.extend(path_v, 0.0);
}

std::vector<PlanView::Splat> PlanView::splatsOf(const Plan& plan) const {
  const Eigen::Vector3f up = up_.cast<float>();
  std::vector<double> heights;
  for (const auto& point : plan.surface) heights.push_back(up.dot(point.position));
  Range range;
  if (!heights.empty()) range = {heights.front(), heights.front()};
  range.extend(std::move(heights), 0.01);
  // Faded, so that the paths stand out.
  const auto faded = [](unsigned char c) { return cv::saturate_cast<uchar>(120 + 0.53 * c); };
  std::vector<Splat> splats;
  for (const auto& point : plan.surface) {
    const float level = up.dot(point.normal);
    if (level < -0.3F) continue;
    Splat splat;
    splat.at = cv::Point(at(point.position.cast<double>()));
    splat.height = up.dot(point.position);
    splat.wall = level < 0.3F && splat.height - static_cast<float>(range.low) > kWall_m;
    splat.color =
        splat.wall ? kWallColor
                   : cv::Vec3b(faded(point.color[0]), faded(point.color[1]), faded(point.color[2]));
    splats.push_back(splat);
  }
  return splats;
}

/// The surface from above; what was seen from far away only, with gaps, is closed from below.
void PlanView::drawSurface(const Plan& plan, cv::Mat& picture) const {
  const std::vector<Splat> splats = splatsOf(plan);
  const int half = std::max(1, static_cast<int>(std::lround(kSplat_m * scale_)));
  drawSplats(splats, 3 * half, false, picture);
  drawSplats(splats, half, true, picture);
}

}  // namespace pf
