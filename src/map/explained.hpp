// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "lower_to.hpp"
#include "measured_surface.hpp"
#include "pixel_box.hpp"
#include "posefusion/core/parallel.hpp"

namespace pf {

/// What agrees with the measurement of a pixel: of the oldest stable surfel that does, the nearest.
/// In one number, so that threads may look for the least.
class Explanation {
 public:
  /// `made`: the frame in which a surfel was made; z: its depth (m).
  static std::int64_t of(std::int32_t made, float z) {
    return (static_cast<std::int64_t>(made) << 32) | static_cast<std::int64_t>(z * kSteps_1_m);
  }
  static std::int32_t made(std::int64_t explanation) {
    return static_cast<std::int32_t>(explanation >> 32);
  }
  static float depth(std::int64_t explanation) {
    return static_cast<float>(explanation & 0xFFFFFFFF) / kSteps_1_m;
  }

 private:
  static constexpr float kSteps_1_m = 1e4F;
};

/// Says of a pixel that no surfel agrees with it.
constexpr std::int64_t kUnexplained = std::numeric_limits<std::int64_t>::max();

/// An Explanation for each pixel of all levels of a measured surface; one made in this frame where
/// only unstable surfels agree.
class Explained {
 public:
  /// Nothing is explained yet.
  void clear(const MeasuredSurface& surface) {
    pixels_.resize(surface.pixels());
    parallelFor(pixels_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      std::fill(pixels_.begin() + static_cast<std::ptrdiff_t>(begin),
                pixels_.begin() + static_cast<std::ptrdiff_t>(end), kUnexplained);
    });
  }

  std::int64_t operator[](std::size_t pixel) const { return pixels_[pixel]; }
  const std::int64_t* at(std::size_t pixel) const { return &pixels_[pixel]; }

  /// Offers an explanation for the pixels of a level around (u, v), `reach` pixels far. Threads may
  /// call it at once: the smallest number stays, whichever comes first.
  void offer(const MeasuredSurface::Level& level, float u, float v, float reach, std::int64_t by) {
    const PixelBox box = pixelsWithin(u, v, reach, level.depth_m.cols, level.depth_m.rows);
    for (int y = box.first_v; y <= box.last_v; ++y) {
      std::int64_t* row = &pixels_[level.at(0, y)];
      for (int x = box.first_u; x <= box.last_u; ++x) {
        lowerTo(row + x, by);
      }
    }
  }

 private:
  static constexpr std::size_t kGrain = 1 << 14;

  std::vector<std::int64_t> pixels_;
};

}  // namespace pf
