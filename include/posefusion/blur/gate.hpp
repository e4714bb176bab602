// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <opencv2/core.hpp>

#include "posefusion/blur/config.hpp"

namespace pf {

/// What the gate says of one frame.
struct BlurScore {
  double score = 0.0;      ///< variance of the Laplacian, grey levels squared
  double threshold = 0.0;  ///< what it was compared with; 0 while nothing is known yet
  bool sharp = true;       ///< the frame may pass
};

/// Variance of the response of the 3x3 Laplacian on the grey image (PFH paper, section III).
/// `color` is CV_8UC3 R G B.
double scoreBlur(const cv::Mat& color);

/// Decides which frames are too blurred, from the score and the recent past. Not thread safe.
class BlurGate {
 public:
  explicit BlurGate(const BlurConfig& config);

  BlurScore judge(double score);
  void reset();

 private:
  double threshold() const;

  BlurConfig config_;
  std::deque<double> accepted_;
  int drops_in_a_row_ = 0;
};

}  // namespace pf
