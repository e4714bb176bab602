// SPDX-License-Identifier: BSD-3-Clause
#include "texture.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/parallel.hpp"
#include "random.hpp"

namespace pf::synthetic {
namespace {

constexpr int kSize = 512;

float lattice(std::uint64_t seed, int x, int y) {
  return uniform(randomBits(seed * 0x1000003U + static_cast<std::uint64_t>(y) * 65536U +
                            static_cast<std::uint64_t>(x)),
                 20);
}

/// Value noise in [0, 1] with `cells_x` by `cells_y` cells to a repeat.
float valueNoise(std::uint64_t seed, float u, float v, int cells_x, int cells_y) {
  const float x = u * static_cast<float>(cells_x), y = v * static_cast<float>(cells_y);
  const int x0 = static_cast<int>(x) % cells_x, y0 = static_cast<int>(y) % cells_y;
  const int x1 = (x0 + 1) % cells_x, y1 = (y0 + 1) % cells_y;
  const auto smooth = [](float f) { return f * f * (3 - 2 * f); };
  const float a = smooth(x - std::floor(x)), b = smooth(y - std::floor(y));
  return (lattice(seed, x0, y0) * (1 - a) + lattice(seed, x1, y0) * a) * (1 - b) +
         (lattice(seed, x0, y1) * (1 - a) + lattice(seed, x1, y1) * a) * b;
}

/// Five octaves, centred on 0, within about [-0.5, 0.5].
float fractalNoise(std::uint64_t seed, float u, float v, int cells_x, int cells_y) {
  float sum = 0, weight = 0.5F;
  for (int octave = 0; octave < 5; ++octave, weight *= 0.6F) {
    const auto s = seed * 8 + static_cast<std::uint64_t>(octave);
    sum += weight * (valueNoise(s, u, v, cells_x << octave, cells_y << octave) - 0.5F);
  }
  return sum * 1.2F;
}

using Painter = std::function<cv::Vec3f(float u, float v)>;

Painter speckled(std::uint64_t seed, cv::Vec3f color, int cells, float contrast) {
  return [=](float u, float v) {
    return color * (1 + contrast * fractalNoise(seed, u, v, cells, cells));
  };
}

/// Planks along v with grain, knots' long waves and dark joints.
Painter planks(std::uint64_t seed, cv::Vec3f color, int count) {
  return [=](float u, float v) {
    const float across = u * static_cast<float>(count);
    const int plank = static_cast<int>(across);
    const float tone = 0.8F + 0.4F * lattice(seed, plank, 7);
    const float grain = fractalNoise(seed + 1 + static_cast<std::uint64_t>(plank), u, v, 48, 3);
    const float wave = fractalNoise(seed + 31, u, v, 6, 2);
    const float rings = 0.12F * std::sin(60 * (u + 0.15F * wave) + 9 * wave);
    const float edge = across - std::floor(across);
    const float joint = edge < 0.03F || edge > 0.97F ? 0.55F : 1.0F;
    return color * (joint * (tone + 0.55F * grain + rings));
  };
}

/// A rug: bordered diamonds in two colours with the roughness of wool.
Painter rug(std::uint64_t seed, cv::Vec3f ground, cv::Vec3f figure) {
  return [=](float u, float v) {
    const float a = std::abs(std::fmod(u * 6, 1.0F) - 0.5F);
    const float b = std::abs(std::fmod(v * 6, 1.0F) - 0.5F);
    const bool inside = a + b < 0.36F && a + b > 0.14F;
    return (inside ? figure : ground) * (1 + 0.7F * fractalNoise(seed, u, v, 40, 40));
  };
}

Painter checker(std::uint64_t seed, cv::Vec3f light, cv::Vec3f dark, int squares) {
  return [=](float u, float v) {
    const int parity = static_cast<int>(u * static_cast<float>(squares)) +
                       static_cast<int>(v * static_cast<float>(squares));
    return (parity % 2 == 0 ? light : dark) * (1 + 0.5F * fractalNoise(seed, u, v, 16, 16));
  };
}

/// Book spines side by side along u, each with its own colour, height and title bands.
Painter bookSpines(std::uint64_t seed) {
  return [=](float u, float v) {
    const int book = static_cast<int>(u * 22);
    const std::uint64_t bits = randomBits(seed * 977 + static_cast<std::uint64_t>(book));
    const cv::Vec3f color(40 + 190 * uniform(bits, 0), 40 + 170 * uniform(bits, 10),
                          40 + 160 * uniform(bits, 20));
    const float top = 0.05F + 0.3F * uniform(bits, 30);
    if (v > 1 - top) return cv::Vec3f(28, 22, 18) * (1 + fractalNoise(seed, u, v, 20, 20));
    const float band = 0.1F + 0.6F * uniform(bits, 40);
    const bool title = v > band && v < band + 0.12F;
    const float round = 1 - 1.2F * std::pow(u * 22 - static_cast<float>(book) - 0.5F, 2.0F);
    return (title ? cv::Vec3f(235, 225, 180) : color) *
           (round * (1 + 0.4F * fractalNoise(seed + 5, u, v, 64, 16)));
  };
}

/// A print: blobs of strong colours over a ground, within a white margin.
Painter print(std::uint64_t seed, cv::Vec3f ground) {
  return [=](float u, float v) {
    if (std::min({u, v, 1 - u, 1 - v}) < 0.05F) return cv::Vec3f(225, 225, 220);
    cv::Vec3f color = ground;
    for (std::uint64_t i = 0; i < 14; ++i) {
      const std::uint64_t bits = randomBits(seed * 131 + i);
      const float du = std::abs(u - 0.1F - 0.8F * uniform(bits, 0));
      const float dv = std::abs(v - 0.1F - 0.8F * uniform(bits, 10));
      const float size = 0.03F + 0.14F * uniform(bits, 20);
      const bool inside =
          i % 2 == 0 ? du < size && dv < size * 0.6F : du * du + dv * dv < size * size;
      if (inside)
        color = {255 * uniform(bits, 30), 255 * uniform(bits, 40), 255 * uniform(bits, 50)};
    }
    return color * (1 + 0.35F * fractalNoise(seed + 3, u, v, 12, 12));
  };
}

/// A knitted jumper: horizontal stripes.
Painter stripes(std::uint64_t seed, cv::Vec3f ground, cv::Vec3f stripe) {
  return [=](float u, float v) {
    const bool in_stripe = std::fmod(v * 8, 1.0F) < 0.35F;
    return (in_stripe ? stripe : ground) * (1 + 0.6F * fractalNoise(seed, u, v, 24, 24));
  };
}

Texture paint(const Painter& painter) {
  cv::Mat image(kSize, kSize, CV_8UC3);
  parallelFor(kSize, 16, [&](std::size_t begin, std::size_t end) {
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row)
      for (int col = 0; col < kSize; ++col)
        image.at<cv::Vec3b>(row, col) = painter((static_cast<float>(col) + 0.5F) / kSize,
                                                (static_cast<float>(row) + 0.5F) / kSize);
  });
  return Texture(image);
}

}  // namespace

Texture::Texture(const cv::Mat& image) {
  levels_.push_back(image);
  while (levels_.back().cols > 1) {
    cv::Mat half;
    cv::resize(levels_.back(), half, {}, 0.5, 0.5, cv::INTER_AREA);
    levels_.push_back(half);
  }
}

cv::Vec3f Texture::sample(float u, float v, float footprint) const {
  const auto bilinear = [u, v](const cv::Mat& image) {
    const int mask = image.cols - 1;
    const float size = static_cast<float>(image.cols);
    const float x = (u - std::floor(u)) * size - 0.5F, y = (v - std::floor(v)) * size - 0.5F;
    const float fx = std::floor(x), fy = std::floor(y);
    const float a = x - fx, b = y - fy;
    const int x0 = static_cast<int>(fx) & mask, x1 = (x0 + 1) & mask;
    const int y0 = static_cast<int>(fy) & mask, y1 = (y0 + 1) & mask;
    const auto* above = image.ptr<cv::Vec3b>(y0);
    const auto* below = image.ptr<cv::Vec3b>(y1);
    cv::Vec3f color;
    for (int c = 0; c < 3; ++c)
      color[c] = (above[x0][c] * (1 - a) + above[x1][c] * a) * (1 - b) +
                 (below[x0][c] * (1 - a) + below[x1][c] * a) * b;
    return color;
  };
  const float top = static_cast<float>(levels_.size() - 1);
  const float level = std::clamp(std::log2(footprint * kSize), 0.0F, top);
  const auto lower = static_cast<std::size_t>(level);
  const float blend = level - static_cast<float>(lower);
  const cv::Vec3f fine = bilinear(levels_[lower]);
  if (blend == 0.0F) return fine;
  return fine * (1 - blend) + bilinear(levels_[lower + 1]) * blend;
}

std::vector<Texture> makeTextures(std::uint32_t seed) {
  const std::uint64_t s = std::uint64_t{seed} * 100;
  const std::vector<Painter> painters = {
      speckled(s + 1, {205, 198, 180}, 10, 0.45F),         // plaster
      planks(s + 2, {165, 120, 80}, 8),                    // boards
      rug(s + 3, {120, 45, 45}, {200, 170, 110}),          // carpet
      speckled(s + 4, {225, 225, 220}, 6, 0.25F),          // ceiling
      planks(s + 5, {190, 145, 95}, 4),                    // wood
      planks(s + 6, {105, 70, 50}, 3),                     // dark_wood
      speckled(s + 7, {70, 95, 140}, 32, 1.0F),            // fabric
      speckled(s + 8, {175, 140, 95}, 12, 0.7F),           // cardboard
      bookSpines(s + 9),                                   // books
      print(s + 10, {60, 110, 160}),                       // poster
      print(s + 11, {190, 160, 70}),                       // painting
      checker(s + 12, {215, 215, 205}, {70, 120, 90}, 8),  // checks
      stripes(s + 13, {165, 50, 45}, {225, 215, 200}),     // shirt
      speckled(s + 14, {55, 65, 95}, 24, 0.8F),            // trousers
      speckled(s + 15, {215, 165, 135}, 8, 0.2F),          // skin
      speckled(s + 16, {60, 42, 30}, 40, 1.2F)};           // hair
  std::vector<Texture> textures;
  for (const Painter& painter : painters) textures.push_back(paint(painter));
  return textures;
}

}  // namespace pf::synthetic
