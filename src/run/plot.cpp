// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/run/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace pf {
namespace {

constexpr int kSize = 900;
constexpr int kPlotMargin = 70;
const cv::Scalar kTruthColor(120, 120, 120), kEstimateColor(20, 90, 220), kError(220, 30, 30);
const cv::Scalar kTextColor(40, 40, 40), kGrid(228, 228, 228);

using Points = std::vector<Eigen::Vector3d>;

/// Maps positions to pixels: the two widest axes of the truth, one scale for both.
class Canvas {
 public:
  explicit Canvas(const Points& points) : image(kSize, kSize, CV_8UC3, cv::Scalar::all(255)) {
    Eigen::AlignedBox3d box;
    for (const auto& p : points) box.extend(p);
    std::array<int, 3> axes = {0, 1, 2};
    const Eigen::Vector3d size = box.sizes();
    std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return size[a] > size[b]; });
    across = std::min(axes[0], axes[1]);
    upward = std::max(axes[0], axes[1]);
    low_ = {box.min()[across], box.min()[upward]};
    scale_ = (kSize - 2 * kPlotMargin) / std::max(1e-3, size[axes[0]]);
  }

  /// In sixteenths of a pixel, as the anti-aliased drawing functions want it.
  cv::Point at(const Eigen::Vector3d& p) const {
    const double u = kPlotMargin + (p[across] - low_.x()) * scale_;
    const double v = kSize - kPlotMargin - (p[upward] - low_.y()) * scale_;
    const auto fixed = [](double x) { return cvRound(std::clamp(x, -1e6, 1e6) * 16); };
    return {fixed(u), fixed(v)};
  }

  void path(const Points& points, const cv::Scalar& color, int width) {
    std::vector<cv::Point> pixels;
    for (const auto& p : points) pixels.push_back(at(p));
    cv::polylines(image, pixels, false, color, width, cv::LINE_AA, 4);
  }

  void line(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const cv::Scalar& color) {
    cv::line(image, at(a), at(b), color, 1, cv::LINE_AA, 4);
  }

  void text(const std::string& text, int x, int y, const cv::Scalar& color) {
    cv::putText(image, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.5, color, 1, cv::LINE_AA);
  }

  /// Grid lines at round distances, with their values.
  void grid() {
    const double wanted = 120.0 / scale_;  // about so many pixels apart
    double step = std::pow(10.0, std::floor(std::log10(wanted)));
    if (wanted / step > 5)
      step *= 5;
    else if (wanted / step > 2)
      step *= 2;
    const double end = (kSize - 2 * kPlotMargin) / scale_;
    for (const int axis : {0, 1}) {
      for (double x = std::ceil(low_[axis] / step) * step; x <= low_[axis] + end; x += step) {
        const int offset = cvRound((x - low_[axis]) * scale_);
        char label[32];
        std::snprintf(label, sizeof(label), "%.3g", std::abs(x) < 1e-9 ? 0.0 : x);
        const int place = axis == 0 ? kPlotMargin + offset : kSize - kPlotMargin - offset;
        const cv::Point from =
            axis == 0 ? cv::Point(place, kPlotMargin) : cv::Point(kPlotMargin, place);
        const cv::Point to = axis == 0 ? cv::Point(place, kSize - kPlotMargin)
                                       : cv::Point(kSize - kPlotMargin, place);
        cv::line(image, from, to, kGrid, 1);
        text(label, axis == 0 ? place - 12 : 12, axis == 0 ? kSize - kPlotMargin + 22 : place + 5,
             kTextColor);
      }
    }
  }

  cv::Mat image;
  int across = 0, upward = 1;

 private:
  Eigen::Vector2d low_;
  double scale_ = 1;
};

}  // namespace

cv::Mat plotTrajectories(const Trajectory& truth, const std::vector<PosePair>& pairs,
                         const Alignment& alignment) {
  Points all, true_path, estimated_path;
  const std::int64_t from = pairs.front().truth.stamp_ns, to = pairs.back().truth.stamp_ns;
  for (const auto& pose : truth) {
    if (pose.stamp_ns < from || pose.stamp_ns > to) continue;
    true_path.emplace_back(pose.T_world_camera.translation());
  }
  for (const auto& pair : pairs) {
    estimated_path.push_back(alignment *
                             Eigen::Vector3d(pair.estimate.T_world_camera.translation()));
  }
  all = true_path;
  all.insert(all.end(), estimated_path.begin(), estimated_path.end());
  Canvas canvas(all);
  canvas.grid();
  canvas.path(true_path, kTruthColor, 2);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    canvas.line(pairs[i].truth.T_world_camera.translation(), estimated_path[i], kError);
  }
  canvas.path(estimated_path, kEstimateColor, 2);
  canvas.text("truth", kPlotMargin, 24, kTruthColor);
  canvas.text("estimate", kPlotMargin + 70, 24, kEstimateColor);
  canvas.text("difference", kPlotMargin + 165, 24, kError);
  const auto error = absoluteError(pairs, alignment);
  char text[128];
  std::snprintf(text, sizeof(text),
                "ATE %.4f m RMSE, %.4f m max, %zu poses; axes %c and %c in metres", error.rmse,
                error.max, error.count, "xyz"[canvas.across], "xyz"[canvas.upward]);
  canvas.text(text, kPlotMargin, 48, kTextColor);
  return canvas.image;
}

}  // namespace pf
