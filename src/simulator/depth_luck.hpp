// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "simulator/random.hpp"

namespace pf::simulator {

/// Random numbers that neighbours share, drawn once for a row.
class RowLuck {
  /// Patterns are matched in windows: errors of neighbours hang together over so many pixels.
  static constexpr int kWindow_px = 4;

 public:
  RowLuck(int row, int width, std::uint32_t key) : key_(key), row_(row) {
    const auto draw = [](int count, std::vector<float>& out, auto&& seed) {
      for (int i = 0; i < count; ++i) {
        out.push_back(gaussian(seed(static_cast<std::uint32_t>(i))));
      }
    };
    const auto window = static_cast<std::uint32_t>(row / kWindow_px);
    const auto block = static_cast<std::uint32_t>(row) / 2U;
    draw(width / kWindow_px + 2, above_, [&](auto i) { return hash(key, i, window); });
    draw(width / kWindow_px + 2, below_, [&](auto i) { return hash(key, i, window + 1U); });
    draw(width / 2 + 1, across_, [&](auto i) { return hash(key, i, block); });
    draw(width / 2 + 1, along_, [&](auto i) { return hash(hash(key, i, block), 1U); });
  }

  /// Smooth noise of unit variance over windows, plus the pixel's own.
  float correlated(int col) const {
    const float x = static_cast<float>(col) / kWindow_px, y = static_cast<float>(row_) / kWindow_px;
    const auto ix = static_cast<std::size_t>(x);
    const float tx = x - std::floor(x), ty = y - std::floor(y);
    const float w[4] = {(1 - tx) * (1 - ty), tx * (1 - ty), (1 - tx) * ty, tx * ty};
    const float sum =
        w[0] * above_[ix] + w[1] * above_[ix + 1] + w[2] * below_[ix] + w[3] * below_[ix + 1];
    const float norm = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2] + w[3] * w[3]);
    const float own = gaussian(
        hash(key_, 0x51U, static_cast<std::uint32_t>(row_), static_cast<std::uint32_t>(col)));
    return 0.8F * sum / norm + 0.6F * own;
  }

  /// Standard normal, for blocks of 2x2 pixels.
  float across(int col) const { return across_[static_cast<std::size_t>(col) / 2]; }
  float along(int col) const { return along_[static_cast<std::size_t>(col) / 2]; }

 private:
  std::uint32_t key_;
  int row_;
  std::vector<float> above_, below_, across_, along_;
};

/// Uniform in [0, 1) and much the same for blocks of 3x3 pixels: depth is lost in specks of a few
/// pixels rather than in single ones.
inline float speckLuck(std::uint32_t key, int row, int col) {
  const std::uint32_t speck =
      hash(key, 0x77U, static_cast<std::uint32_t>(row) / 3U, static_cast<std::uint32_t>(col) / 3U);
  const std::uint32_t own = hash(speck, static_cast<std::uint32_t>(col % 3 * 3 + row % 3));
  return 0.6F * uniform(speck) + 0.4F * uniform(own);
}

}  // namespace pf::simulator
