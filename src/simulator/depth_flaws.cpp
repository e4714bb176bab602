// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/depth_flaws.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pf::simulator {
namespace {

/// Whether depth jumps between the pixel and one of its four neighbours.
bool atRim(const cv::Mat& depth, int row, int col) {
  const float z = depth.at<std::uint16_t>(row, col);
  const auto jumps = [&](int dr, int dc) {
    const int r = row + dr, c = col + dc;
    if (r < 0 || c < 0 || r >= depth.rows || c >= depth.cols) return false;
    return std::abs(static_cast<float>(depth.at<std::uint16_t>(r, c)) - z) > 0.08F * z;
  };
  return jumps(-1, 0) || jumps(1, 0) || jumps(0, -1) || jumps(0, 1);
}

void loseRims(double probability, std::uint32_t key, cv::Mat& depth) {
  const cv::Mat before = depth.clone();
  for (int row = 0; row < depth.rows; ++row) {
    for (int col = 0; col < depth.cols; ++col) {
      if (before.at<std::uint16_t>(row, col) == 0 || !atRim(before, row, col)) continue;
      const auto r = static_cast<std::uint32_t>(row), c = static_cast<std::uint32_t>(col);
      // Pieces of rims, not pixels, are lost.
      const float luck =
          0.7F * uniform(hash(key, r / 4U, c / 4U)) + 0.3F * uniform(hash(key, r, c));
      if (luck < probability) depth.at<std::uint16_t>(row, col) = 0;
    }
  }
}

void losePatch(Dice& dice, cv::Mat& depth) {
  const double x = dice.between(0, depth.cols), y = dice.between(0, depth.rows);
  const double a = dice.between(2, 16), b = dice.between(2, 12), part = dice.between(0.4, 1.2);
  const std::uint32_t key = dice.next();
  for (int row = 0; row < depth.rows; ++row) {
    for (int col = 0; col < depth.cols; ++col) {
      const double dx = (col - x) / a, dy = (row - y) / b;
      if (dx * dx + dy * dy > 1.0) continue;
      const auto r = static_cast<std::uint32_t>(row), c = static_cast<std::uint32_t>(col);
      if (uniform(hash(key, r / 2U, c / 2U)) < part) depth.at<std::uint16_t>(row, col) = 0;
    }
  }
}

}  // namespace

DepthConfig drawDepthConfig(int shrink, Dice& dice) {
  static const std::array<double, 5> nearest = {0.26, 0.4, 0.5, 0.5, 0.7};
  DepthConfig config;
  config.min_m = nearest[static_cast<std::size_t>(dice.below(5))];
  config.max_m = dice.between(3.5, 9.0);
  config.baseline_m = dice.between(0.05, 0.09);
  // The same steps of depth at a focal length that is shorter in pixels.
  config.disparity_steps = 8.0 * shrink * dice.between(0.6, 1.6);
  config.axial = dice.between(0.3, 1.0);  // neighbours' errors hang together: a median keeps half
  config.lateral = dice.between(0.5, 2.5) / shrink;
  config.distortion = dice.between(0.0, 1.5);
  config.specimen = dice.below(1000000);
  config.dropouts = dice.between(0.2, 1.3);
  config.shadow = !dice.chance(0.15);
  return config;
}

void addFlaws(Dice& dice, cv::Mat& depth_mm) {
  if (dice.chance(0.6)) {
    const double probability = dice.between(0.05, 0.8);
    loseRims(probability, dice.next(), depth_mm);
  }
  if (dice.chance(0.12)) {
    for (int i = dice.below(4); i >= 0; --i) losePatch(dice, depth_mm);
  }
  // Registered depth does not reach the borders of the colour image.
  const int border = dice.below(5);
  if (dice.chance(0.4)) depth_mm.colRange(0, border).setTo(0);
  if (dice.chance(0.4)) depth_mm.colRange(depth_mm.cols - border, depth_mm.cols).setTo(0);
  if (dice.chance(0.2)) depth_mm.rowRange(0, border).setTo(0);
}

}  // namespace pf::simulator
