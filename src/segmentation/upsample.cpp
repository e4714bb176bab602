// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/upsample.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr float kHoleOdds = 5.0F;

/// The cells around one pixel vote for its label, each with its nearness in depth (or colour, where
/// one of the two has no depth) and in the image.
bool votePerson(const SceneGrid& grid, const std::vector<std::uint8_t>& labels, const cv::Point& at,
                float z, const cv::Vec3b& color) {
  const int col0 = at.x / grid.step, row0 = at.y / grid.step;
  float person = 0.0F, other = 0.0F;
  for (int row = std::max(0, row0 - 1); row <= std::min(grid.rows - 1, row0 + 1); ++row) {
    for (int col = std::max(0, col0 - 1); col <= std::min(grid.cols - 1, col0 + 1); ++col) {
      const int cell = row * grid.cols + col;
      const float du = static_cast<float>(at.x) / grid.step - (col + 0.5F);
      const float dv = static_cast<float>(at.y) / grid.step - (row + 0.5F);
      float badness = 0.7F * (du * du + dv * dv);
      if (z > 0.0F && grid.hasDepth(cell)) {
        const float gap = (z - grid.z[cell]) / (0.015F + 0.01F * z);
        badness += std::min(gap * gap, 30.0F);
      } else if (z > 0.0F) {
        const cv::Vec3b& c = grid.color.at<cv::Vec3b>(row, col);
        float square = 0.0F;
        for (int k = 0; k < 3; ++k) {
          const float difference = static_cast<float>(color[k]) - static_cast<float>(c[k]);
          square += difference * difference;
        }
        badness += std::min(square / 1200.0F, 8.0F) + 4.0F;
      }
      (labels[cell] ? person : other) += std::exp(-badness);
    }
  }
  // Missing depth along an edge is shadow on the background; inside a person it is a person.
  return person > (z > 0.0F ? other : kHoleOdds * other);
}

/// 0 or 1 if all cells around and including this have that label, else 2.
int surroundings(const SceneGrid& grid, const std::vector<std::uint8_t>& labels, int row, int col) {
  int persons = 0, cells = 0;
  for (int r = std::max(0, row - 1); r <= std::min(grid.rows - 1, row + 1); ++r) {
    for (int c = std::max(0, col - 1); c <= std::min(grid.cols - 1, col + 1); ++c) {
      persons += labels[r * grid.cols + c];
      ++cells;
    }
  }
  return persons == 0 ? 0 : persons == cells ? 1 : 2;
}

}  // namespace

void upsampleMask(const RgbdFrame& frame, const cv::Mat& depth_m, const SceneGrid& grid,
                  const std::vector<std::uint8_t>& labels, cv::Mat& mask) {
  mask.create(depth_m.size(), CV_8UC1);
  parallelFor(grid.rows, 8, [&](std::size_t begin, std::size_t end) {
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      for (int col = 0; col < grid.cols; ++col) {
        const cv::Rect block = cv::Rect(col * grid.step, row * grid.step, grid.step, grid.step) &
                               cv::Rect(0, 0, mask.cols, mask.rows);
        const int kind = surroundings(grid, labels, row, col);
        for (int y = block.y; y < block.y + block.height; ++y) {
          for (int x = block.x; x < block.x + block.width; ++x) {
            const bool person = kind == 2
                                    ? votePerson(grid, labels, {x, y}, depth_m.at<float>(y, x),
                                                 frame.color.at<cv::Vec3b>(y, x))
                                    : kind == 1;
            mask.at<std::uint8_t>(y, x) = person ? 255 : 0;
          }
        }
      }
    }
  });
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
