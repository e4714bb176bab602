// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "posefusion/segmentation/grid.hpp"

namespace pf {

/// Frequencies of colours, 8 x 8 x 8 bins of R G B, smoothed.
class ColorHistogram {
 public:
  static constexpr int kBins = 512;
  static int binOf(const cv::Vec3b& color) {
    return (color[0] >> 5) * 64 + (color[1] >> 5) * 8 + (color[2] >> 5);
  }

  void clear();
  void add(int bin, float weight = 1.0F);
  /// Spreads counts over neighbouring bins (noise, shading) and makes them sum to 1.
  void smoothAndNormalise();
  /// Moves towards another normalised histogram by `part` of the way (0..1).
  void blend(const ColorHistogram& newer, float part);

  float total() const { return total_; }
  float probability(int bin) const { return count_[bin]; }

 private:
  std::array<float, kBins> count_{};
  float total_ = 0.0F;
};

/// Logarithm of the ratio of probabilities, limited to +-limit; a floor keeps unseen colours
/// neutral.
float logLikelihoodRatio(const ColorHistogram& inside, const ColorHistogram& outside, int bin,
                         float limit);

}  // namespace pf
