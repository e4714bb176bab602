// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/appearance.hpp"

#include <algorithm>
#include <cmath>

namespace pf {
namespace {

constexpr int kBinsPerAxis = 8;

/// One pass of the kernel (1 2 1) / 4 along the axis with the given stride, the border repeated.
void smoothAxis(std::array<float, ColorHistogram::kBins>& count, int stride) {
  const auto source = count;
  for (int bin = 0; bin < ColorHistogram::kBins; ++bin) {
    const int coordinate = bin / stride % kBinsPerAxis;
    const int below = coordinate > 0 ? bin - stride : bin;
    const int above = coordinate < kBinsPerAxis - 1 ? bin + stride : bin;
    count[bin] = 0.25F * source[below] + 0.5F * source[bin] + 0.25F * source[above];
  }
}

}  // namespace

void ColorHistogram::clear() {
  count_.fill(0.0F);
  total_ = 0.0F;
}

void ColorHistogram::add(int bin, float weight) {
  count_[bin] += weight;
  total_ += weight;
}

void ColorHistogram::smoothAndNormalise() {
  if (total_ <= 0.0F) return;
  for (int stride : {1, kBinsPerAxis, kBinsPerAxis * kBinsPerAxis}) smoothAxis(count_, stride);
  for (float& value : count_) value /= total_;
}

void ColorHistogram::blend(const ColorHistogram& newer, float part) {
  if (newer.total_ <= 0.0F) return;
  if (total_ <= 0.0F) part = 1.0F;
  for (int bin = 0; bin < kBins; ++bin) {
    count_[bin] += part * (newer.count_[bin] - count_[bin]);
  }
  total_ = newer.total_;
}

float logLikelihoodRatio(const ColorHistogram& inside, const ColorHistogram& outside, int bin,
                         float limit) {
  constexpr float kFloor = 5e-4F;  // a quarter of the uniform probability of a bin
  if (inside.total() <= 0.0F || outside.total() <= 0.0F) return 0.0F;
  const float ratio =
      std::log((inside.probability(bin) + kFloor) / (outside.probability(bin) + kFloor));
  return std::clamp(ratio, -limit, limit);
}

}  // namespace pf
