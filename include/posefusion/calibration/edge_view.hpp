// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/core/frame.hpp"

namespace pf {

/// What one frame says of how its colour lies over its depth: steps of depth are edges in colour.
struct EdgeView {
  std::vector<float> x, y;     ///< where depth steps, pixels
  std::vector<float> inverse;  ///< of the nearer side, 1/m
  cv::Mat strength;            ///< CV_8UC1, how much colour is an edge there
  double mean_strength = 0;    ///< of all pixels

  std::size_t size() const { return x.size(); }
};

/// `frame`: without lens distortion.
EdgeView edgeView(const RgbdFrame& frame);

}  // namespace pf
