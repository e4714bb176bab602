// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/frame/picture_noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace pf {
namespace {

constexpr int kBlock = 16;

/// Mean distance of the block's pixels from what their neighbours say, as a standard deviation.
template <typename Grey>
double noiseOfBlock(const cv::Mat& image, int left, int top) {
  double sum = 0;
  for (int v = top + 1; v < top + kBlock - 1; ++v) {
    const Grey *above = image.ptr<Grey>(v - 1), *row = image.ptr<Grey>(v),
               *below = image.ptr<Grey>(v + 1);
    for (int u = left + 1; u < left + kBlock - 1; ++u) {
      const auto corners =
          static_cast<float>(above[u - 1] + above[u + 1] + below[u - 1] + below[u + 1]);
      const auto sides = static_cast<float>(above[u] + below[u] + row[u - 1] + row[u + 1]);
      sum += std::abs(corners - 2 * sides + 4 * static_cast<float>(row[u]));
    }
  }
  constexpr double kPixels = (kBlock - 2) * (kBlock - 2);
  return std::sqrt(M_PI / 2) / 6 * sum / kPixels;
}

}  // namespace

double pictureNoise(const cv::Mat& intensity) {
  const bool is_float = intensity.type() == CV_32FC1;
  std::vector<double> blocks;
  for (int top = 0; top + kBlock <= intensity.rows; top += kBlock) {
    for (int left = 0; left + kBlock <= intensity.cols; left += kBlock) {
      blocks.push_back(is_float ? noiseOfBlock<float>(intensity, left, top)
                                : noiseOfBlock<std::uint8_t>(intensity, left, top));
    }
  }
  if (blocks.empty()) return 0;
  const auto quarter = blocks.begin() + static_cast<std::ptrdiff_t>(blocks.size() / 4);
  std::nth_element(blocks.begin(), quarter, blocks.end());
  return *quarter;
}

}  // namespace pf
