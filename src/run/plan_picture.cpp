// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/run/plan_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace pf {
namespace {

constexpr int kWidth = 1200, kTallest = 1000, kMargin = 30, kLegend = 104;
constexpr int kFine = 2;            // drawn so much larger and scaled down: smooth lines
constexpr float kSplat_m = 0.012F;  // half the side of a point of the surface
constexpr float kWall_m = 1.0F;     // upright surface higher than this above the lowest is wall
constexpr std::int64_t kGapNs = 500'000'000;  // the path is broken at longer ones
const cv::Scalar kPaper(255, 255, 255), kInk(45, 45, 50), kTruth(30, 30, 30),
    kEstimate(0, 104, 210), kWrong(222, 30, 40);

struct Range {
  double low = 0, high = 0;
  double size() const { return high - low; }
};

/// The range of the values without the outermost per cent on each side; of none: empty.
void extend(std::vector<double> values, double cut, Range& range) {
  if (values.empty()) return;
  std::sort(values.begin(), values.end());
  const auto skip = static_cast<std::size_t>(cut * static_cast<double>(values.size()));
  range.low = std::min(range.low, values[skip]);
  range.high = std::max(range.high, values[values.size() - 1 - skip]);
}

/// From the frame of the truth to the picture.
class View {
 public:
  explicit View(const Plan& plan) : up_(upOf(plan.truth)) {
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

  double scale() const { return scale_; }  ///< pixels for a metre
  int height() const { return 2 * kMargin + static_cast<int>(scale_ * v_.size()); }
  const Eigen::Vector3d& up() const { return up_; }

  cv::Point2d at(const Eigen::Vector3d& point) const {
    return {kMargin + shift_ + scale_ * (right_.dot(point) - u_.low),
            kMargin + scale_ * (v_.high - ahead_.dot(point))};
  }

 private:
  void measure(const Plan& plan) {
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
    extend(u, 0.002, u_);
    extend(v, 0.002, v_);
    extend(path_u, 0.0, u_);
    extend(path_v, 0.0, v_);
  }

  Eigen::Vector3d up_, right_, ahead_;
  Range u_, v_;
  double scale_ = 1, shift_ = 0;
};

/// The surface from above: the highest point of each pixel.
void drawSurface(const Plan& plan, const View& view, cv::Mat& picture) {
  cv::Mat height(picture.size(), CV_32FC1, cv::Scalar(-std::numeric_limits<float>::max()));
  const Eigen::Vector3f up = view.up().cast<float>();
  std::vector<double> heights;
  for (const auto& point : plan.surface) heights.push_back(up.dot(point.position));
  Range range;
  if (!heights.empty()) range = {heights.front(), heights.front()};
  extend(std::move(heights), 0.01, range);
  const int half = std::max(1, static_cast<int>(std::lround(kSplat_m * view.scale())));
  for (const auto& point : plan.surface) {
    const float level = up.dot(point.normal), h = up.dot(point.position);
    if (level < -0.3F) continue;
    const bool wall = level < 0.3F && h - static_cast<float>(range.low) > kWall_m;
    const cv::Point2d at = view.at(point.position.cast<double>());
    const cv::Rect splat(cvRound(at.x) - half, cvRound(at.y) - half, 2 * half + 1, 2 * half + 1);
    const cv::Rect inside = splat & cv::Rect({0, 0}, picture.size());
    // Faded, so that the paths stand out.
    const auto faded = [](unsigned char c) { return cv::saturate_cast<uchar>(120 + 0.53 * c); };
    const cv::Vec3b color =
        wall ? cv::Vec3b(142, 146, 152)
             : cv::Vec3b(faded(point.color[0]), faded(point.color[1]), faded(point.color[2]));
    for (int y = inside.y; y < inside.br().y; ++y) {
      for (int x = inside.x; x < inside.br().x; ++x) {
        if (h <= height.at<float>(y, x)) continue;
        height.at<float>(y, x) = h;
        picture.at<cv::Vec3b>(y, x) = color;
      }
    }
  }
}

/// Draws in the large picture, in pixels of the small one.
class Pen {
 public:
  explicit Pen(cv::Mat& large) : image_(large) {}

  void line(const std::vector<cv::Point2d>& points, const cv::Scalar& color, double width) {
    std::vector<cv::Point> pixels;
    for (const auto& p : points) pixels.push_back(fixed(p));
    cv::polylines(image_, pixels, false, color, cvRound(kFine * width), cv::LINE_AA, kShift);
  }
  void dot(const cv::Point2d& at, double radius, const cv::Scalar& color) {
    cv::circle(image_, fixed(at), cvRound(kFine * radius * (1 << kShift)), color, -1, cv::LINE_AA,
               kShift);
  }
  void square(const cv::Point2d& at, double half, const cv::Scalar& color) {
    cv::rectangle(image_, fixed(at - cv::Point2d(half, half)), fixed(at + cv::Point2d(half, half)),
                  color, -1, cv::LINE_AA, kShift);
  }
  void text(const std::string& text, const cv::Point2d& at, double size = 0.5) {
    cv::putText(image_, text, cv::Point(kFine * at), cv::FONT_HERSHEY_SIMPLEX, kFine * size, kInk,
                kFine, cv::LINE_AA);
  }

 private:
  static constexpr int kShift = 4;
  static cv::Point fixed(const cv::Point2d& p) {
    const double unit = kFine * (1 << kShift);
    return {cvRound(std::clamp(p.x, -1e4, 1e4) * unit), cvRound(std::clamp(p.y, -1e4, 1e4) * unit)};
  }
  cv::Mat& image_;
};

void drawPath(const Trajectory& path, const View& view, const cv::Scalar& color, double width,
              Pen& pen) {
  std::vector<cv::Point2d> points;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0 && path[i].stamp_ns - path[i - 1].stamp_ns > kGapNs) {
      pen.line(points, color, width);
      points.clear();
    }
    points.push_back(view.at(path[i].T_world_camera.translation()));
  }
  pen.line(points, color, width);
}

void drawMarks(const Plan& plan, const View& view, Pen& pen) {
  const auto at = [&](const StampedPose& pose) {
    return view.at(pose.T_world_camera.translation());
  };
  for (const std::size_t i : plan.wrong) pen.dot(at(plan.estimate[i]), 3.5, kWrong);
  const auto ends = [&](const Trajectory& path, const cv::Scalar& color) {
    if (path.empty()) return;
    pen.dot(at(path.front()), 8, kPaper);
    pen.dot(at(path.front()), 6, color);
    pen.square(at(path.back()), 7, kPaper);
    pen.square(at(path.back()), 5, color);
  };
  ends(plan.truth, kTruth);
  ends(plan.estimate, kEstimate);
}

/// The largest of 1, 2, 5 times a power of ten that is at most `size`.
double roundBelow(double size) {
  const double power = std::pow(10.0, std::floor(std::log10(size)));
  return power * (size >= 5 * power ? 5 : size >= 2 * power ? 2 : 1);
}

void drawLegend(const Plan& plan, const View& view, int top, Pen& pen) {
  const double y = top + 30;
  double x = kMargin;
  const auto entry = [&](const char* name, double width, const auto& draw) {
    draw(cv::Point2d(x, y - 5));
    pen.text(name, {x + 42, y});
    x += 42 + width;
  };
  const auto stroke = [&](const cv::Scalar& color, double width) {
    return [&pen, color, width](const cv::Point2d& p) {
      pen.line({p, {p.x + 32, p.y}}, color, width);
    };
  };
  entry("truth", 74, stroke(kTruth, 2));
  entry("estimate", 104, stroke(kEstimate, 2));
  entry("wrong pose", 124, [&](const cv::Point2d& p) { pen.dot({p.x + 16, p.y}, 4, kWrong); });
  entry("start", 74, [&](const cv::Point2d& p) { pen.dot({p.x + 16, p.y}, 6, kInk); });
  entry("end", 74, [&](const cv::Point2d& p) { pen.square({p.x + 16, p.y}, 5, kInk); });
  pen.text(plan.title, {kMargin, y + 40});

  const double length_m = roundBelow(200 / view.scale()), right = kWidth - kMargin;
  const double left = right - length_m * view.scale();
  pen.line({{left, y - 5}, {right, y - 5}}, kInk, 3);
  for (const double end : {left, right}) pen.line({{end, y - 11}, {end, y + 1}}, kInk, 2);
  char label[32];
  std::snprintf(label, sizeof(label), "%g m", length_m);
  pen.text(label, {left, y + 22});
}

}  // namespace

Eigen::Vector3d upOf(const Trajectory& trajectory) {
  Eigen::Vector3d down = Eigen::Vector3d::Zero();
  for (const auto& pose : trajectory) down += pose.T_world_camera.linear().col(1);
  const Eigen::Vector3d up = -down.normalized();
  Eigen::Index axis = 0;
  const double most = up.cwiseAbs().maxCoeff(&axis);
  if (most < std::cos(M_PI / 6)) return up;
  return std::copysign(1.0, up[axis]) * Eigen::Vector3d::Unit(axis);
}

cv::Mat drawPlan(const Plan& plan) {
  const View view(plan);
  cv::Mat room(view.height() + kLegend, kWidth, CV_8UC3, kPaper);
  drawSurface(plan, view, room);
  room.rowRange(view.height(), room.rows) = kPaper;
  cv::Mat large;
  cv::resize(room, large, {}, kFine, kFine, cv::INTER_LINEAR);
  Pen pen(large);
  drawPath(plan.truth, view, kTruth, 2, pen);
  drawPath(plan.estimate, view, kEstimate, 2, pen);
  drawMarks(plan, view, pen);
  drawLegend(plan, view, view.height(), pen);
  cv::Mat picture;
  cv::resize(large, picture, room.size(), 0, 0, cv::INTER_AREA);
  return picture;
}

}  // namespace pf
