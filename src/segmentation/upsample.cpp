// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/upsample.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr float kHoleOdds = 5.0F;  // votes for a person must be so many times the others' in a hole
constexpr float kPerCell2 = 0.7F;  // badness for each squared cell between pixel and cell
// Depth: the gap that counts 1, which grows with the depth, and the most that it can count.
constexpr float kDepthGap_m = 0.015F, kDepthGapPerMetre = 0.01F, kMaxDepthBadness = 30.0F;
// Colour, where the cell has no depth: the squared difference that counts 1, and the most.
constexpr float kColorSquare = 1200.0F, kMaxColorBadness = 8.0F;
constexpr float kNoDepthBadness = 4.0F;
constexpr std::size_t kRowsAtOnce = 8;

struct Pixel {
  cv::Point at;
  float z;  // metres, 0: none
  cv::Vec3b color;
};

float colorBadness(const cv::Vec3b& a, const cv::Vec3b& b) {
  float square = 0.0F;
  for (int k = 0; k < 3; ++k) {
    const float difference = static_cast<float>(a[k]) - static_cast<float>(b[k]);
    square += difference * difference;
  }
  return std::min(square / kColorSquare, kMaxColorBadness);
}

/// How little a cell says of a pixel.
float badnessOf(const SceneGrid& grid, int cell, const Pixel& pixel) {
  const int row = cell / grid.cols, col = cell % grid.cols;
  const float du = static_cast<float>(pixel.at.x) / grid.step - (col + 0.5F);
  const float dv = static_cast<float>(pixel.at.y) / grid.step - (row + 0.5F);
  const float badness = kPerCell2 * (du * du + dv * dv);
  if (pixel.z <= 0.0F) return badness;
  if (!grid.hasDepth(cell)) {
    return badness + colorBadness(pixel.color, grid.color.at<cv::Vec3b>(row, col)) +
           kNoDepthBadness;
  }
  const float gap = (pixel.z - grid.z[cell]) / (kDepthGap_m + kDepthGapPerMetre * pixel.z);
  return badness + std::min(gap * gap, kMaxDepthBadness);
}

/// The cells around one pixel vote for its label, each with its nearness in depth (or colour, where
/// one of the two has no depth) and in the image.
bool votePerson(const SceneGrid& grid, const std::vector<std::uint8_t>& labels,
                const Pixel& pixel) {
  const int col0 = pixel.at.x / grid.step, row0 = pixel.at.y / grid.step;
  float person = 0.0F, other = 0.0F;
  for (int row = std::max(0, row0 - 1); row <= std::min(grid.rows - 1, row0 + 1); ++row) {
    for (int col = std::max(0, col0 - 1); col <= std::min(grid.cols - 1, col0 + 1); ++col) {
      const int cell = row * grid.cols + col;
      (labels[cell] ? person : other) += std::exp(-badnessOf(grid, cell, pixel));
    }
  }
  // Missing depth along an edge is shadow on the background; inside a person it is a person.
  return person > (pixel.z > 0.0F ? other : kHoleOdds * other);
}

enum class Surroundings { other, person, mixed };

/// The labels of the cells around and including this.
Surroundings surroundings(const SceneGrid& grid, const std::vector<std::uint8_t>& labels, int row,
                          int col) {
  int persons = 0, cells = 0;
  for (int r = std::max(0, row - 1); r <= std::min(grid.rows - 1, row + 1); ++r) {
    for (int c = std::max(0, col - 1); c <= std::min(grid.cols - 1, col + 1); ++c) {
      persons += labels[r * grid.cols + c];
      ++cells;
    }
  }
  if (persons == 0) return Surroundings::other;
  return persons == cells ? Surroundings::person : Surroundings::mixed;
}

}  // namespace

cv::Mat upsampleMask(const RgbdFrame& frame, const cv::Mat& depth_m, const SceneGrid& grid,
                     const std::vector<std::uint8_t>& labels) {
  cv::Mat mask(depth_m.size(), CV_8UC1, cv::Scalar(0));
  const auto fillBlock = [&](int row, int col) {
    const Surroundings kind = surroundings(grid, labels, row, col);
    if (kind == Surroundings::other) return;
    const cv::Rect block = cv::Rect(col * grid.step, row * grid.step, grid.step, grid.step) &
                           cv::Rect(0, 0, mask.cols, mask.rows);
    for (int y = block.y; y < block.y + block.height; ++y) {
      for (int x = block.x; x < block.x + block.width; ++x) {
        const bool person =
            kind == Surroundings::person ||
            votePerson(grid, labels,
                       {{x, y}, depth_m.at<float>(y, x), frame.color.at<cv::Vec3b>(y, x)});
        mask.at<std::uint8_t>(y, x) = person ? 255 : 0;
      }
    }
  };
  parallelFor(grid.rows, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      for (int col = 0; col < grid.cols; ++col) fillBlock(row, col);
    }
  });
  return mask;
}

cv::Mat removeMasked(const cv::Mat& depth, const cv::Mat& mask, int margin_px) {
  cv::Mat removed;  // not a view of the mask: that stays as it is
  const cv::Size size(2 * margin_px + 1, 2 * margin_px + 1);
  cv::dilate(mask, removed, cv::getStructuringElement(cv::MORPH_RECT, size));
  cv::Mat rest = depth.clone();
  rest.setTo(0, removed);
  return rest;
}

}  // namespace pf
