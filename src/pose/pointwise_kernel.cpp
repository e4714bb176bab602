// SPDX-License-Identifier: BSD-3-Clause
#include "pointwise_kernel.hpp"

#include <algorithm>
#include <cstring>

#include "posefusion/core/parallel.hpp"

namespace pf::kernel {
namespace {

/// A tile of kChannelsAtOnce channels and 2 * Lanes pixels, which the registers hold: Lanes is how
/// many floats one of them has.
template <int Lanes>
__attribute__((always_inline)) inline void convolveTile(const float* in, std::size_t plane,
                                                        const float* weights, int inputs,
                                                        const float* bias, float* out,
                                                        int channels) {
  typedef float Lane __attribute__((vector_size(Lanes * sizeof(float))));
  Lane sums[kChannelsAtOnce][2];
#pragma GCC unroll 6
  for (int o = 0; o < kChannelsAtOnce; ++o) sums[o][0] = sums[o][1] = Lane{} + bias[o];
  for (int i = 0; i < inputs; ++i, in += plane, weights += kChannelsAtOnce) {
    Lane first, second;
    std::memcpy(&first, in, sizeof first);
    std::memcpy(&second, in + Lanes, sizeof second);
#pragma GCC unroll 6
    for (int o = 0; o < kChannelsAtOnce; ++o) {
      sums[o][0] += first * weights[o];
      sums[o][1] += second * weights[o];
    }
  }
#pragma GCC unroll 6
  for (int o = 0; o < kChannelsAtOnce; ++o) {
    if (o >= channels) break;
    std::memcpy(out + o * plane, &sums[o], sizeof sums[o]);
  }
}

template <int Lanes>
__attribute__((always_inline)) inline void convolve(const PointwiseWeights& w, const float* in,
                                                    std::size_t plane, std::size_t begin,
                                                    std::size_t end, float* out) {
  constexpr std::size_t kPixels = 2 * Lanes;
  static_assert(kPixels <= kLeastPixels, "the last tile is moved back to fit");
  for (std::size_t pixel = begin; pixel < end; pixel += kPixels) {
    const std::size_t at = std::min(pixel, end - kPixels);
    for (int o = 0; o < w.outputs; o += kChannelsAtOnce) {
      convolveTile<Lanes>(in + at, plane, &w.weights[static_cast<std::size_t>(o) * w.inputs],
                          w.inputs, &w.bias[o], out + o * plane + at,
                          std::min(kChannelsAtOnce, w.outputs - o));
    }
  }
}

// One of these is picked at run time. The compiler could clone a single function
// (core/parallel.hpp), but then the size of a tile could not follow that of a register.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(POSEFUSION_NO_CLONES)
__attribute__((target("avx512f"))) void convolveBest(const PointwiseWeights& w, const float* in,
                                                     std::size_t plane, std::size_t begin,
                                                     std::size_t end, float* out) {
  convolve<16>(w, in, plane, begin, end, out);
}

__attribute__((target("avx2"))) void convolveBest(const PointwiseWeights& w, const float* in,
                                                  std::size_t plane, std::size_t begin,
                                                  std::size_t end, float* out) {
  convolve<8>(w, in, plane, begin, end, out);
}

__attribute__((target("default")))
#endif
void convolveBest(const PointwiseWeights& w, const float* in, std::size_t plane, std::size_t begin,
                  std::size_t end, float* out) {
  convolve<4>(w, in, plane, begin, end, out);
}

}  // namespace

PointwiseWeights PointwiseWeights::packed(const float* weights, const float* bias, int outputs,
                                          int inputs) {
  const auto groups = static_cast<std::size_t>((outputs + kChannelsAtOnce - 1) / kChannelsAtOnce);
  PointwiseWeights packed;
  packed.inputs = inputs;
  packed.outputs = outputs;
  packed.weights.assign(groups * kChannelsAtOnce * static_cast<std::size_t>(inputs), 0.0F);
  packed.bias.assign(groups * kChannelsAtOnce, 0.0F);
  for (int o = 0; o < outputs; ++o) {
    packed.bias[o] = bias[o];
    const std::size_t group = o / kChannelsAtOnce, place = o % kChannelsAtOnce;
    for (int i = 0; i < inputs; ++i) {
      packed.weights[(group * inputs + i) * kChannelsAtOnce + place] =
          weights[static_cast<std::size_t>(o) * inputs + i];
    }
  }
  return packed;
}

void convolvePixels(const PointwiseWeights& weights, const float* in, std::size_t plane,
                    std::size_t begin, std::size_t end, float* out) {
  convolveBest(weights, in, plane, begin, end, out);
}

POSEFUSION_SIMD_CLONES
void applyLine(const float* x, int count, float factor, float offset, float* y) {
  for (int i = 0; i < count; ++i) y[i] = x[i] * factor + offset;
}

}  // namespace pf::kernel
