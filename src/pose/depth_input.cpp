// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/pose/depth_input.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();

/// First pixel of each cell along one axis, and the end of the last.
std::vector<int> bordersOf(int cells, double start_px, double step_px, int pixels) {
  std::vector<int> borders;
  for (int i = 0; i <= cells; ++i) {
    const double border = start_px + i * step_px;
    borders.push_back(std::clamp(static_cast<int>(std::lround(border)), 0, pixels));
  }
  return borders;
}

int widest(const std::vector<int>& borders) {
  int most = 0;
  for (std::size_t i = 1; i < borders.size(); ++i) {
    most = std::max(most, borders[i] - borders[i - 1]);
  }
  return most;
}

/// The smaller one of each pair into `low`.
POSEFUSION_SIMD_CLONES
void order(float* low, float* high) {
  for (int i = 0; i < kDepthInputWidth; ++i) {
    const float a = low[i], b = high[i];
    low[i] = b < a ? b : a;
    high[i] = b < a ? a : b;
  }
}

/// A row of cells: value k of all cells side by side, so that all are sorted at once.
class CellRow {
 public:
  explicit CellRow(int values)
      : values_(values), data_(static_cast<std::size_t>(values) * kDepthInputWidth) {}

  void gather(const cv::Mat& depth_m, int top, int bottom, const std::vector<int>& columns,
              int width) {
    std::fill(data_.begin(), data_.end(), kNone);
    count_.assign(kDepthInputWidth, 0);
    for (int y = top; y < bottom; ++y) {
      const float* row = depth_m.ptr<float>(y);
      float* out = lane((y - top) * width);
      for (int cell = 0; cell < kDepthInputWidth; ++cell) {
        const int begin = columns[static_cast<std::size_t>(cell)];
        const int end = columns[static_cast<std::size_t>(cell) + 1];
        for (int x = begin; x < end; ++x) {
          const bool valid = row[x] > kDepthInputNearest_m && row[x] < kDepthInputFarthest_m;
          out[(x - begin) * kDepthInputWidth + cell] = valid ? row[x] : kNone;
          count_[static_cast<std::size_t>(cell)] += valid ? 1 : 0;
        }
      }
    }
  }

  /// Batcher's odd-even merge sort: a fixed order of comparisons, the same for all cells.
  void sort() {
    for (int p = 1; p < values_; p *= 2) {
      for (int k = p; k >= 1; k /= 2) {
        for (int j = k % p; j + k < values_; j += 2 * k) {
          for (int i = j; i < std::min(j + k, values_ - k); ++i) {
            if (i / (2 * p) == (i + k) / (2 * p)) order(lane(i), lane(i + k));
          }
        }
      }
    }
  }

  /// The lower median of a sorted cell; 0: too few values.
  float median(int cell, int least) {
    const int count = count_[static_cast<std::size_t>(cell)];
    return count < least ? 0.0F : lane((count - 1) / 2)[cell];
  }

 private:
  float* lane(int value) { return &data_[static_cast<std::size_t>(value) * kDepthInputWidth]; }

  int values_;
  std::vector<float> data_;
  std::vector<int> count_;
};

}  // namespace

cv::Point2f DepthInputGrid::toImage(const cv::Point2f& cell) const {
  return {static_cast<float>(left_px + (cell.x + 0.5) * step_px - 0.5),
          static_cast<float>(top_px + (cell.y + 0.5) * step_px - 0.5)};
}

DepthInputGrid depthInputGrid(const cv::Size& image) {
  DepthInputGrid grid;
  grid.step_px = std::max(static_cast<double>(image.width) / kDepthInputWidth,
                          static_cast<double>(image.height) / kDepthInputHeight);
  grid.left_px = 0.5 * (image.width - kDepthInputWidth * grid.step_px);
  grid.top_px = 0.5 * (image.height - kDepthInputHeight * grid.step_px);
  return grid;
}

void shrinkDepth(const cv::Mat& depth_m, cv::Mat& small_m) {
  small_m.create(kDepthInputHeight, kDepthInputWidth, CV_32FC1);
  small_m.setTo(0.0F);
  if (depth_m.empty()) return;
  const DepthInputGrid grid = depthInputGrid(depth_m.size());
  const auto columns = bordersOf(kDepthInputWidth, grid.left_px, grid.step_px, depth_m.cols);
  const auto rows = bordersOf(kDepthInputHeight, grid.top_px, grid.step_px, depth_m.rows);
  const int width = widest(columns), height = widest(rows);
  const int least = width * height <= 2 ? 1 : 2;
  parallelFor(rows.size() - 1, 15, [&](std::size_t begin, std::size_t end) {
    CellRow cells(width * height);
    for (std::size_t row = begin; row < end; ++row) {
      cells.gather(depth_m, rows[row], rows[row + 1], columns, width);
      cells.sort();
      float* out = small_m.ptr<float>(static_cast<int>(row));
      for (int cell = 0; cell < kDepthInputWidth; ++cell) out[cell] = cells.median(cell, least);
    }
  });
}

void depthInput(const cv::Mat& small_m, cv::Mat& blob) {
  blob.create({1, 3, kDepthInputHeight, kDepthInputWidth}, CV_32F);
  auto* inverse = blob.ptr<float>(0, 0);
  auto* logarithm = blob.ptr<float>(0, 1);
  auto* valid = blob.ptr<float>(0, 2);
  for (int y = 0; y < small_m.rows; ++y) {
    const auto* row = small_m.ptr<float>(y);
    for (int x = 0; x < small_m.cols; ++x) {
      const bool seen = row[x] > 0.0F;
      *inverse++ = seen ? 1.0F / row[x] : 0.0F;
      *logarithm++ = seen ? std::log(row[x]) : 0.0F;
      *valid++ = seen ? 1.0F : 0.0F;
    }
  }
}

}  // namespace pf
