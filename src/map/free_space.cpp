// SPDX-License-Identifier: BSD-3-Clause
#include "free_space.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr int kRows = 16;  // of a task

/// Where all of 3x3 pixels see at least that far (m); 0 where the centre sees nothing.
POSEFUSION_SIMD_CLONES
void nearestOf3x3(const float* above, const float* row, const float* below, float* nearest,
                  int width) {
  constexpr float kFar = 1e9F;
  for (int u = 0; u < width; ++u) {
    const int left = u > 0 ? u - 1 : 0, right = u < width - 1 ? u + 1 : width - 1;
    float smallest = kFar;
    for (const float* d : {above, row, below}) {
      const float a = d[left], b = d[u], c = d[right];
      const float fa = a > 0 ? a : kFar, fb = b > 0 ? b : kFar, fc = c > 0 ? c : kFar;
      const float ab = fa < fb ? fa : fb, abc = ab < fc ? ab : fc;
      smallest = smallest < abc ? smallest : abc;
    }
    nearest[u] = row[u] > 0 ? smallest : 0.0F;
  }
}

}  // namespace

void findFreeSpace(const WorkingFrame& frame, const cv::Mat& input_m, cv::Mat& seen_m,
                   cv::Mat& free_m) {
  cv::max(frame.depth_m, frame.beyond_m, seen_m);
  if (!input_m.empty()) cv::max(seen_m, input_m, seen_m);
  free_m.create(seen_m.size(), CV_32FC1);
  parallelFor(seen_m.rows, kRows, [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
      nearestOf3x3(seen_m.ptr<float>(std::max(0, v - 1)), seen_m.ptr<float>(v),
                   seen_m.ptr<float>(std::min(seen_m.rows - 1, v + 1)), free_m.ptr<float>(v),
                   seen_m.cols);
    }
  });
}

void findGaps(const cv::Mat& seen_m, const cv::Mat& mask, cv::Mat& people, cv::Mat& gaps) {
  cv::compare(seen_m, 0, gaps, cv::CMP_GT);
  if (!mask.empty()) {
    cv::resize(mask, people, seen_m.size(), 0, 0, cv::INTER_AREA);
    cv::bitwise_or(gaps, people, gaps);
  }
  cv::dilate(gaps, gaps, cv::Mat());
  cv::compare(gaps, 0, gaps, cv::CMP_EQ);
}

}  // namespace pf
