// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace pf {

/// What lies next to pixels without depth.
class Surroundings {
 public:
  /// `depth_m`: CV_32FC1, 0 = none, people removed; may be empty. `still`: any size, CV_8UC1, 0 = a
  /// person's pixel; empty: no people.
  Surroundings(const cv::Mat& depth_m, const cv::Mat& still);

  /// Depth (m) of the next thing to be seen beside a pixel; 0 of a person, outside, and where
  /// nothing is seen at all.
  double depthBeside(const cv::Point2f& pixel) const;

 private:
  cv::Size full_;
  cv::Mat nearest_;              ///< of each cell: number of the nearest that shows something
  std::vector<float> depth_of_;  ///< by that number (m); 0 of a person
};

}  // namespace pf
