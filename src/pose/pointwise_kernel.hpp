// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

/// What a small network does most, on plain arrays: convolutions of 1x1 pixels, and scales.
namespace pf::kernel {

/// Output channels that are summed at once, and the least pixels that can be.
constexpr int kChannelsAtOnce = 6;
constexpr std::size_t kLeastPixels = 32;

/// Weights in the order in which they are read.
struct PointwiseWeights {
  int inputs = 0, outputs = 0;
  std::vector<float> weights;  ///< [group of kChannelsAtOnce outputs][input][output of the group]
  std::vector<float> bias;     ///< for each output, 0 up to a whole number of groups

  /// `weights`: outputs x inputs, row by row.
  static PointwiseWeights packed(const float* weights, const float* bias, int outputs, int inputs);
};

/// For the pixels [begin, end), at least kLeastPixels of them,
///   out[o][pixel] = bias[o] + sum over i of weights[o][i] in[i][pixel],
/// i in order: the same bits whatever the instruction set. Planes are `plane` floats apart.
void convolvePixels(const PointwiseWeights& weights, const float* in, std::size_t plane,
                    std::size_t begin, std::size_t end, float* out);

/// y = factor x + offset.
void applyLine(const float* x, int count, float factor, float offset, float* y);

}  // namespace pf::kernel
