// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/error.hpp"

namespace pf::simulator {
namespace {

float srgbToLinear(float s) {
  return s <= 0.04045F ? s / 12.92F : std::pow((s + 0.055F) / 1.055F, 2.4F);
}

std::array<float, 256> makeLinearTable() {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = srgbToLinear(static_cast<float>(i) / 255.0F);
  }
  return table;
}

const std::array<float, 256>& linearTable() {
  static const auto table = makeLinearTable();
  return table;
}

float contrastOf(const cv::Mat& linear) {
  cv::Mat grey, around;
  cv::transform(linear, grey, cv::Matx13f(1.0F / 3.0F, 1.0F / 3.0F, 1.0F / 3.0F));
  cv::blur(grey, around, {9, 9});
  const double mean = std::max(cv::mean(grey)[0], 0.01);
  return static_cast<float>(cv::norm(grey, around) / std::sqrt(grey.total()) / mean);
}

}  // namespace

float linearOf(std::uint8_t srgb) { return linearTable()[srgb]; }

std::uint8_t srgbOf(float linear) {
  const float l = std::clamp(linear, 0.0F, 1.0F);
  const float s = l <= 0.0031308F ? 12.92F * l : 1.055F * std::pow(l, 1.0F / 2.4F) - 0.055F;
  return static_cast<std::uint8_t>(std::lround(255.0F * s));
}

Texture::Texture(const cv::Mat& picture) {
  cv::Mat linear(picture.size(), CV_32FC3);
  for (int row = 0; row < picture.rows; ++row) {
    for (int col = 0; col < picture.cols; ++col) {
      const auto& p = picture.at<cv::Vec3b>(row, col);
      linear.at<cv::Vec3f>(row, col) = {linearOf(p[0]), linearOf(p[1]), linearOf(p[2])};
    }
  }
  const cv::Scalar mean = cv::mean(linear);
  mean_ = Eigen::Vector3d(mean[0], mean[1], mean[2]).cast<float>();
  contrast_ = contrastOf(linear);
  for (;;) {
    Level level;
    level.side = linear.cols;
    for (int i = 0; i < linear.rows * linear.cols; ++i) {
      const cv::Vec3f& p = linear.at<cv::Vec3f>(i / linear.cols, i % linear.cols);
      for (int c = 0; c < 3; ++c) level.rgbx.push_back(srgbOf(p[c]));
      level.rgbx.push_back(255);
    }
    levels_.push_back(std::move(level));
    if (linear.cols == 1) break;
    cv::resize(linear, linear, {linear.cols / 2, linear.rows / 2}, 0, 0, cv::INTER_AREA);
  }
}

Eigen::Vector3f Texture::sample(float u, float v, float footprint) const {
  // Half a level sharper than the footprint: the optics of the camera blur the rest.
  const float texels = footprint * static_cast<float>(levels_[0].side) * 0.7F;
  const int wanted = texels <= 1.0F ? 0 : static_cast<int>(std::log2(texels));
  const Level& level =
      levels_[std::min<std::size_t>(static_cast<std::size_t>(wanted), levels_.size() - 1)];
  const int mask = level.side - 1;
  const float x = u * static_cast<float>(level.side) - 0.5F;
  const float y = v * static_cast<float>(level.side) - 0.5F;
  const float fx = std::floor(x), fy = std::floor(y);
  const int x0 = static_cast<int>(fx) & mask, y0 = static_cast<int>(fy) & mask;
  const int x1 = (x0 + 1) & mask, y1 = (y0 + 1) & mask;
  const float tx = x - fx, ty = y - fy;
  const auto& table = linearTable();
  const auto at = [&](int col, int row) { return &level.rgbx[4U * (row * level.side + col)]; };
  const std::uint8_t *a = at(x0, y0), *b = at(x1, y0), *c = at(x0, y1), *d = at(x1, y1);
  Eigen::Vector3f color;
  for (int k = 0; k < 3; ++k) {
    const float top = table[a[k]] + (table[b[k]] - table[a[k]]) * tx;
    const float bottom = table[c[k]] + (table[d[k]] - table[c[k]]) * tx;
    color[k] = top + (bottom - top) * ty;
  }
  return color;
}

cv::Mat paintTexture(const std::string& kind, std::uint32_t seed) {
  cv::Mat picture = paintSurface(kind, seed);
  if (picture.empty()) picture = paintPrint(kind, seed);
  if (!picture.empty()) return picture;
  std::string known;
  for (const auto& word : textureKinds()) known += (known.empty() ? "" : ", ") + word;
  throw InputError("texture '" + kind + "' is unknown, expected one of " + known);
}

}  // namespace pf::simulator
