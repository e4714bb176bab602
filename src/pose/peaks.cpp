// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/pose/peaks.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace pf {
namespace {

// Half of OpenPose's enlargement (to the network's input): the centroid hides the difference.
constexpr int kEnlargement = 4;
constexpr int kCentroidRadius = 3;

/// Above all neighbours; of equal ones the first in reading order counts, a plain none.
bool isPeak(const cv::Mat& map, int x, int y) {
  const float value = map.at<float>(y, x);
  bool above_one = false;
  for (int dy = -1; dy <= 1; ++dy) {
    const int yy = y + dy;
    if (yy < 0 || yy >= map.rows) continue;
    for (int dx = -1; dx <= 1; ++dx) {
      const int xx = x + dx;
      if ((dx == 0 && dy == 0) || xx < 0 || xx >= map.cols) continue;
      const float other = map.at<float>(yy, xx);
      const bool earlier = dy < 0 || (dy == 0 && dx < 0);
      if (other > value || (other == value && earlier)) return false;
      above_one |= other < value;
    }
  }
  return above_one;
}

Peak centroid(const cv::Mat& map, int x, int y) {
  double sum = 0, sum_x = 0, sum_y = 0;
  for (int yy = std::max(0, y - kCentroidRadius); yy <= std::min(map.rows - 1, y + kCentroidRadius);
       ++yy) {
    for (int xx = std::max(0, x - kCentroidRadius);
         xx <= std::min(map.cols - 1, x + kCentroidRadius); ++xx) {
      const double weight = std::max(0.0F, map.at<float>(yy, xx));
      sum += weight;
      sum_x += weight * xx;
      sum_y += weight * yy;
    }
  }
  const auto toHeatMap = [](double enlarged) {
    return static_cast<float>((enlarged + 0.5) / kEnlargement - 0.5);
  };
  return {toHeatMap(sum_x / sum), toHeatMap(sum_y / sum), map.at<float>(y, x)};
}

}  // namespace

void PeakFinder::find(const cv::Mat& heat_map, float min_peak, int max_peaks,
                      std::vector<Peak>& peaks) {
  peaks.clear();
  cv::resize(heat_map, enlarged_, heat_map.size() * kEnlargement, 0, 0, cv::INTER_CUBIC);
  for (int y = 0; y < enlarged_.rows; ++y) {
    const float* row = enlarged_.ptr<float>(y);
    for (int x = 0; x < enlarged_.cols; ++x) {
      if (row[x] > min_peak && isPeak(enlarged_, x, y)) peaks.push_back(centroid(enlarged_, x, y));
    }
  }
  std::stable_sort(peaks.begin(), peaks.end(),
                   [](const Peak& a, const Peak& b) { return a.p > b.p; });
  if (static_cast<int>(peaks.size()) > max_peaks) peaks.resize(max_peaks);
}

}  // namespace pf
