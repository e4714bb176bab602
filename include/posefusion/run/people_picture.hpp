// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/slam/pipeline.hpp"

namespace pf {

/// The colour image (CV_8UC3 R G B) with the people's joints and limbs and, where `mask` is not
/// empty, its pixels tinted. A copy.
cv::Mat drawPeople(const cv::Mat& color, const People& people, const cv::Mat& mask);

/// Keeps a few frames of a run, evenly spread over it however long it gets: frames with people, or
/// any where there never are people.
class PeopleStrip {
 public:
  void add(const ProcessedFrame& frame);

  /// The kept frames side by side, two rows; empty before the first sharp frame.
  cv::Mat draw() const;

 private:
  /// Every n-th frame; n doubles when the places are full.
  struct Sample {
    std::size_t seen = 0;
    std::size_t every = 1;
    std::vector<cv::Mat> pictures;

    void add(const ProcessedFrame& frame);
  };

  Sample with_people_, any_;
};

}  // namespace pf
