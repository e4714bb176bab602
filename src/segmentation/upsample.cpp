// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/upsample.hpp"

#include <algorithm>
#include <cstring>
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

/// The pixels of one block, as arrays for the kernel.
struct BlockPixels {
  static constexpr int kMost = 64;  // at once
  int count = 0;
  float u[kMost], v[kMost];  // in cells
  float z[kMost];            // metres, 0: none
  float inverse_gap[kMost];  // 1 / the gap in depth that counts 1
  float color[3][kMost];

  void add(const RgbdFrame& frame, const cv::Mat& depth_m, int step, const cv::Point& at) {
    const int i = count++;
    u[i] = static_cast<float>(at.x) / static_cast<float>(step);
    v[i] = static_cast<float>(at.y) / static_cast<float>(step);
    z[i] = depth_m.at<float>(at);
    inverse_gap[i] = 1.0F / (kDepthGap_m + kDepthGapPerMetre * z[i]);
    const cv::Vec3b& seen = frame.color.at<cv::Vec3b>(at);
    for (int k = 0; k < 3; ++k) color[k][i] = static_cast<float>(seen[k]);
  }
};

/// What a cell says of the pixels around it.
struct CellVote {
  float u, v;  // of its centre, in cells
  float z;     // metres, 0: none
  float color[3];
};

/// exp(-x) for 0 <= x, to seven digits, without branches so that it can become SIMD code.
inline float expOfNegative(float x) {
  constexpr float kLog2e = 1.44269504F, kLeast = -80.0F;
  float t = -x * kLog2e;
  t = t < kLeast ? kLeast : t;
  const int whole = static_cast<int>(t) - 1;  // t <= 0: what is left lies in (0, 1]
  const float f = t - static_cast<float>(whole);
  // 2^f by its Taylor series around 1/2, to the seventh power.
  constexpr float kRoot2 = 1.41421356F, kLn2 = 0.693147181F;
  const float g = (f - 0.5F) * kLn2;
  const float power =
      kRoot2 *
      (1.0F + g * (1.0F + g * (0.5F + g * (1.0F / 6 + g * (1.0F / 24 +
                                                           g * (1.0F / 120 + g * (1.0F / 720)))))));
  const std::int32_t bits = (whole + 127) << 23;
  float scale = 0;
  std::memcpy(&scale, &bits, sizeof scale);
  return power * scale;
}

/// Adds a cell's vote to each pixel's sum: its nearness in depth (or colour, where the cell has no
/// depth) and in the image.
POSEFUSION_SIMD_CLONES
void addVotes(const BlockPixels& p, const CellVote& cell, float* __restrict sums) {
  const float has_depth = cell.z > 0.0F ? 1.0F : 0.0F;
  for (int i = 0; i < p.count; ++i) {
    const float du = p.u[i] - cell.u, dv = p.v[i] - cell.v;
    const float gap = (p.z[i] - cell.z) * p.inverse_gap[i];
    const float of_depth = gap * gap < kMaxDepthBadness ? gap * gap : kMaxDepthBadness;
    const float r = p.color[0][i] - cell.color[0], g = p.color[1][i] - cell.color[1];
    const float b = p.color[2][i] - cell.color[2];
    const float square = (r * r + g * g + b * b) * (1.0F / kColorSquare);
    const float of_color =
        kNoDepthBadness + (square < kMaxColorBadness ? square : kMaxColorBadness);
    const float known = p.z[i] > 0.0F ? 1.0F : 0.0F;
    const float more = known * (has_depth * of_depth + (1.0F - has_depth) * of_color);
    sums[i] += expOfNegative(kPerCell2 * (du * du + dv * dv) + more);
  }
}

/// A frame, the labels of its cells, and the mask that is filled block by block.
struct Upsampling {
  const RgbdFrame& frame;
  const cv::Mat& depth_m;
  const SceneGrid& grid;
  const std::vector<std::uint8_t>& labels;
  cv::Mat& mask;
  cv::Mat any, all;  // of the labels of 3x3 cells

  Upsampling(const RgbdFrame& of, const cv::Mat& of_depth_m, const SceneGrid& cells,
             const std::vector<std::uint8_t>& of_cells, cv::Mat& filled)
      : frame(of), depth_m(of_depth_m), grid(cells), labels(of_cells), mask(filled) {
    const cv::Mat image(grid.rows, grid.cols, CV_8UC1, const_cast<std::uint8_t*>(labels.data()));
    cv::dilate(image, any, cv::noArray());
    cv::erode(image, all, cv::noArray());
  }

  /// The cells around a block vote for the labels of its pixels.
  void vote(int row0, int col0, const BlockPixels& pixels, std::uint8_t* is_person) const {
    float person[BlockPixels::kMost] = {}, other[BlockPixels::kMost] = {};
    for (int row = std::max(0, row0 - 1); row <= std::min(grid.rows - 1, row0 + 1); ++row) {
      for (int col = std::max(0, col0 - 1); col <= std::min(grid.cols - 1, col0 + 1); ++col) {
        const int cell = row * grid.cols + col;
        const cv::Vec3b& color = grid.color.ptr<cv::Vec3b>(row)[col];
        const CellVote vote{static_cast<float>(col) + 0.5F,
                            static_cast<float>(row) + 0.5F,
                            grid.z[cell],
                            {static_cast<float>(color[0]), static_cast<float>(color[1]),
                             static_cast<float>(color[2])}};
        addVotes(pixels, vote, labels[cell] != 0 ? person : other);
      }
    }
    // Missing depth along an edge is shadow on the background; inside a person it is a person.
    for (int i = 0; i < pixels.count; ++i) {
      is_person[i] = person[i] > (pixels.z[i] > 0.0F ? other[i] : kHoleOdds * other[i]) ? 255 : 0;
    }
  }

  void fillByVotes(int row, int col, const cv::Rect& block) const {
    BlockPixels pixels;
    std::uint8_t is_person[BlockPixels::kMost];
    std::uint8_t* filled[BlockPixels::kMost];
    for (int y = block.y; y < block.br().y; ++y) {
      for (int x = block.x; x < block.br().x; ++x) {
        filled[pixels.count] = mask.ptr<std::uint8_t>(y) + x;
        pixels.add(frame, depth_m, grid.step, {x, y});
        const bool is_last = y + 1 == block.br().y && x + 1 == block.br().x;
        if (pixels.count < BlockPixels::kMost && !is_last) continue;
        vote(row, col, pixels, is_person);
        for (int i = 0; i < pixels.count; ++i) *filled[i] = is_person[i];
        pixels.count = 0;
      }
    }
  }

  void fill(int row, int col) const {
    if (any.ptr<std::uint8_t>(row)[col] == 0) return;
    const cv::Rect block = cv::Rect(col * grid.step, row * grid.step, grid.step, grid.step) &
                           cv::Rect(0, 0, mask.cols, mask.rows);
    if (all.ptr<std::uint8_t>(row)[col] == 0) return fillByVotes(row, col, block);
    for (int y = block.y; y < block.br().y; ++y) {
      std::memset(mask.ptr<std::uint8_t>(y) + block.x, 255, static_cast<std::size_t>(block.width));
    }
  }
};

}  // namespace

cv::Mat upsampleMask(const RgbdFrame& frame, const cv::Mat& depth_m, const SceneGrid& grid,
                     const std::vector<std::uint8_t>& labels) {
  cv::Mat mask(depth_m.size(), CV_8UC1, cv::Scalar(0));
  const Upsampling upsampling(frame, depth_m, grid, labels, mask);
  parallelFor(grid.rows, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      for (int col = 0; col < grid.cols; ++col) upsampling.fill(row, col);
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
