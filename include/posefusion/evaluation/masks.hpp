// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "posefusion/pose/skeleton.hpp"

namespace pf {

/// Means over frames. A frame without any mask pixel has no precision and does not count in it.
struct MaskScore {
  int frames = 0;
  double iou = 0;
  double recall = 0;
  double precision = 0;
};

/// The true person pixels that the detector found: parts of the true mask, connected where the
/// depth jumps by less than 0.1 m, of at least 500 pixels with three joints or more inside. Pixels
/// without depth join the part they touch. `truth`: CV_8UC1, > 0 = person; `depth_m`: CV_32FC1, 0 =
/// invalid.
cv::Mat foundParts(const cv::Mat& truth, const cv::Mat& depth_m, const People& people);

/// Compares masks of people with true ones, frame by frame (CV_8UC1, > 0 = person).
class MaskCheck {
 public:
  void add(const cv::Mat& truth, const cv::Mat& mask);
  /// Only for frames that the detector looked at. Pixels of undetected people do not count.
  void addFound(const cv::Mat& truth, const cv::Mat& mask, const cv::Mat& found);

  /// Frames in which people cover more than 2 %.
  MaskScore crowded() const { return mean(crowded_); }
  /// Found people, over frames that have some.
  MaskScore found() const { return mean(found_); }
  /// Mean part of all pixels that are masked though no person is there.
  double falseFraction() const { return frames_ > 0 ? false_sum_ / frames_ : 0.0; }
  int frames() const { return frames_; }

 private:
  struct Sums {
    int frames = 0, masked = 0;
    double iou = 0, recall = 0, precision = 0;
  };
  static void add(const cv::Mat& truth, const cv::Mat& mask, Sums& sums);
  static MaskScore mean(const Sums& sums);

  Sums crowded_, found_;
  int frames_ = 0;
  double false_sum_ = 0;
};

}  // namespace pf
