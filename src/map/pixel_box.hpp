// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

namespace pf {

/// The pixels of an image from the first to the last, both included; empty where first > last.
struct PixelBox {
  int first_u, last_u, first_v, last_v;

  bool isEmpty() const { return first_u > last_u || first_v > last_v; }
};

/// The pixels whose centres are no farther than `reach` from (u, v) across and down.
inline PixelBox pixelsWithin(float u, float v, float reach, int width, int height) {
  constexpr float kAlmostOne = 0.9999F;  // int(x + kAlmostOne) rounds x up
  const float right = u + reach, bottom = v + reach;
  // Casts cut towards zero: rounding down, since nothing below zero is left after max().
  const float left = std::max(0.0F, u - reach) + kAlmostOne;
  const float top = std::max(0.0F, v - reach) + kAlmostOne;
  if (!(right >= 0 && bottom >= 0 && left < static_cast<float>(width) &&
        top < static_cast<float>(height))) {
    return {0, -1, 0, -1};
  }
  return {static_cast<int>(left), static_cast<int>(std::min(right, static_cast<float>(width - 1))),
          static_cast<int>(top),
          static_cast<int>(std::min(bottom, static_cast<float>(height - 1)))};
}

}  // namespace pf
