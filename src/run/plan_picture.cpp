// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/run/plan_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "plan_view.hpp"

namespace pf {
namespace {

constexpr int kLegend = 104;
constexpr double kPathWidth = 2;
constexpr int kFine = 2;                       // drawn so much larger and scaled down: smooth lines
constexpr std::int64_t kGap_ns = 500'000'000;  // the path is broken at longer ones
const cv::Scalar kPaper(255, 255, 255), kInk(45, 45, 50), kTruth(30, 30, 30),
    kEstimate(0, 104, 210), kWrong(222, 30, 40);

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

void drawPath(const Trajectory& path, const PlanView& view, const cv::Scalar& color, Pen& pen) {
  std::vector<cv::Point2d> points;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0 && path[i].stamp_ns - path[i - 1].stamp_ns > kGap_ns) {
      pen.line(points, color, kPathWidth);
      points.clear();
    }
    points.push_back(view.at(path[i].T_world_camera.translation()));
  }
  pen.line(points, color, kPathWidth);
}

void drawMarks(const Plan& plan, const PlanView& view, Pen& pen) {
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

void drawLegend(const Plan& plan, const PlanView& view, int top, Pen& pen) {
  const double y = top + 30;
  double x = PlanView::kMargin;
  const auto entry = [&](const char* name, double width, const auto& draw) {
    draw(cv::Point2d(x, y - 5));
    pen.text(name, {x + 42, y});
    x += 42 + width;
  };
  const auto stroke = [&](const cv::Scalar& color) {
    return [&pen, color](const cv::Point2d& p) {
      pen.line({p, {p.x + 32, p.y}}, color, kPathWidth);
    };
  };
  if (!plan.truth.empty()) entry("truth", 74, stroke(kTruth));
  entry("estimate", 104, stroke(kEstimate));
  if (!plan.truth.empty()) {
    entry("wrong pose", 124, [&](const cv::Point2d& p) { pen.dot({p.x + 16, p.y}, 4, kWrong); });
  }
  entry("start", 74, [&](const cv::Point2d& p) { pen.dot({p.x + 16, p.y}, 6, kInk); });
  entry("end", 74, [&](const cv::Point2d& p) { pen.square({p.x + 16, p.y}, 5, kInk); });
  pen.text(plan.title, {PlanView::kMargin, y + 40});

  const double length_m = roundBelow(200 / view.scale()),
               right = PlanView::kWidth - PlanView::kMargin;
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
  const PlanView view(plan);
  cv::Mat room(view.height() + kLegend, PlanView::kWidth, CV_8UC3, kPaper);
  view.drawSurface(plan, room);
  room.rowRange(view.height(), room.rows) = kPaper;
  cv::Mat large;
  cv::resize(room, large, {}, kFine, kFine, cv::INTER_LINEAR);
  Pen pen(large);
  drawPath(plan.truth, view, kTruth, pen);
  drawPath(plan.estimate, view, kEstimate, pen);
  drawMarks(plan, view, pen);
  drawLegend(plan, view, view.height(), pen);
  cv::Mat picture;
  cv::resize(large, picture, room.size(), 0, 0, cv::INTER_AREA);
  return picture;
}

}  // namespace pf
