// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace pf {

/// A candidate for a joint, in pixels of the heat map (pixel centres at integers).
struct Peak {
  float x = 0.0F;
  float y = 0.0F;
  float p = 0.0F;  ///< height of the peak
};

/// Finds the peaks of heat maps with sub-pixel positions: the map is enlarged (cubic), a pixel
/// above its eight neighbours and above a threshold is a peak, and its position is the
/// centroid of the 7x7 pixels around it (Cao et al. 2017, "Realtime Multi-Person 2D Pose Estimation
/// using Part Affinity Fields", and the published OpenPose settings). Keeps its buffer.
class PeakFinder {
 public:
  /// `heat_map`: CV_32FC1. At most `max_peaks` of them, highest first.
  void find(const cv::Mat& heat_map, float min_peak, int max_peaks, std::vector<Peak>& peaks);

 private:
  cv::Mat enlarged_;
};

}  // namespace pf
