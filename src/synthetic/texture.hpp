// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace pf::synthetic {

/// A square image that repeats, with its halved copies for distant views.
class Texture {
 public:
  /// `image` is CV_8UC3 R G B, square, its size a power of two.
  explicit Texture(const cv::Mat& image);

  /// Colour (0..255) at (u, v), one repeat being 1, seen with `footprint` repeats to a pixel.
  /// Interpolated within and between the levels, so that nothing flickers as the camera moves.
  cv::Vec3f sample(float u, float v, float footprint) const;

 private:
  std::vector<cv::Mat> levels_;
};

/// The surfaces of the room, indices into makeTextures().
enum class Surface : std::uint8_t {
  plaster,
  boards,
  carpet,
  ceiling,
  wood,
  dark_wood,
  fabric,
  cardboard,
  books,
  poster,
  painting,
  checks,
  shirt,
  trousers,
  skin,
  hair
};

/// All surfaces in the order of the enumeration. A function of the seed.
std::vector<Texture> makeTextures(std::uint32_t seed);

}  // namespace pf::synthetic
