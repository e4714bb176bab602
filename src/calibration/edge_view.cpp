// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/edge_view.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace pf {
namespace {

constexpr double kNoLimit_m = 1e3;
constexpr float kStep = 0.06F;         // part of the depth: more than a slope or the noise
constexpr double kBlur = 1.5 / 640.0;  // of the width: what counts as the same edge
constexpr std::size_t kSteps = 2000;   // of a view

void addStep(float nearer, float x, float y, EdgeView& view) {
  view.x.push_back(x);
  view.y.push_back(y);
  view.inverse.push_back(1.0F / nearer);
}

void addStepsOfRow(const cv::Mat& depth_m, int v, EdgeView& view) {
  const auto *here = depth_m.ptr<float>(v), *below = depth_m.ptr<float>(v + 1);
  const auto is_step = [](float a, float b) {
    return a > 0 && b > 0 && std::abs(a - b) > kStep * std::min(a, b);
  };
  for (int u = 0; u + 1 < depth_m.cols; ++u) {
    const auto x = static_cast<float>(u), y = static_cast<float>(v);
    if (is_step(here[u], here[u + 1])) addStep(std::min(here[u], here[u + 1]), x + 0.5F, y, view);
    if (is_step(here[u], below[u])) addStep(std::min(here[u], below[u]), x, y + 0.5F, view);
  }
}

/// The slope of the grey levels: a quarter at its mean, and never more than one.
cv::Mat strengthOf(const cv::Mat& color) {
  cv::Mat grey, right, down, slope, strength;
  cv::cvtColor(color, grey, cv::COLOR_RGB2GRAY);
  grey.convertTo(grey, CV_32F);
  cv::GaussianBlur(grey, grey, {}, std::max(0.7, kBlur * color.cols));
  cv::Sobel(grey, right, CV_32F, 1, 0);
  cv::Sobel(grey, down, CV_32F, 0, 1);
  cv::magnitude(right, down, slope);
  cv::Mat(slope + 3.0 * std::max(1e-3, cv::mean(slope)[0])).copyTo(strength);
  cv::divide(slope, strength, strength, 255.0);
  strength.convertTo(strength, CV_8U);
  return strength;
}

}  // namespace

EdgeView edgeView(const RgbdFrame& frame) {
  cv::Mat depth_m;
  depthInMetres(frame, 0.0, kNoLimit_m, depth_m);
  EdgeView all, view;
  for (int v = 0; v + 1 < depth_m.rows; ++v) addStepsOfRow(depth_m, v, all);
  const std::size_t count = std::min(kSteps, all.size());
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = i * all.size() / count;
    view.x.push_back(all.x[k]);
    view.y.push_back(all.y[k]);
    view.inverse.push_back(all.inverse[k]);
  }
  view.strength = strengthOf(frame.color);
  view.mean_strength = cv::mean(view.strength)[0];
  return view;
}

}  // namespace pf
