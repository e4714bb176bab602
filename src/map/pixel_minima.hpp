// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "posefusion/core/parallel.hpp"

namespace pf {

/// For each pixel, the smallest of the keys that any thread offered: whatever their order. A buffer
/// for each thread costs less than atomic ones.
class PixelMinima {
 public:
  static constexpr std::uint64_t kNothing = ~std::uint64_t{0};

  /// Nothing was offered.
  void clear(std::size_t pixels) {
    pixels_ = pixels;
    minima_.resize(pixels);
    for (std::vector<std::uint64_t>& own : own_) own.resize(pixels);
    parallelFor(pixels, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::vector<std::uint64_t>& own : own_) {
        std::fill(own.begin() + begin, own.begin() + end, kNothing);
      }
    });
  }

  /// What the calling thread offers: it may lower it.
  std::uint64_t* own() {
    std::vector<std::uint64_t>& own = own_.local();
    if (own.size() != pixels_) own.assign(pixels_, kNothing);
    return own.data();
  }

  /// Call it when all have offered.
  void combine() {
    parallelFor(pixels_, kGrain, [&](std::size_t begin, std::size_t end) {
      std::fill(minima_.begin() + begin, minima_.begin() + end, kNothing);
      for (const std::vector<std::uint64_t>& own : own_) {
        for (std::size_t i = begin; i < end; ++i) minima_[i] = std::min(minima_[i], own[i]);
      }
    });
  }

  std::uint64_t operator[](std::size_t pixel) const { return minima_[pixel]; }

 private:
  static constexpr std::size_t kGrain = 1 << 13;

  std::size_t pixels_ = 0;
  std::vector<std::uint64_t> minima_;
  tbb::enumerable_thread_specific<std::vector<std::uint64_t>> own_;
};

}  // namespace pf
