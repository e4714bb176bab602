// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/random.hpp"

#include <array>

namespace pf::simulator {
namespace {

constexpr int kTableBits = 12;

/// Quantiles of the standard normal at the middles of 4096 equal parts, by bisection of erfc.
std::array<float, 1 << kTableBits> normalQuantiles() {
  std::array<float, 1 << kTableBits> table{};
  const int count = static_cast<int>(table.size());
  for (int i = 0; i < count; ++i) {
    const double p = (i + 0.5) / count;
    double low = -5.0, high = 5.0;
    for (int k = 0; k < 40; ++k) {
      const double middle = 0.5 * (low + high);
      (0.5 * std::erfc(-middle / std::sqrt(2.0)) < p ? low : high) = middle;
    }
    table[static_cast<std::size_t>(i)] = static_cast<float>(0.5 * (low + high));
  }
  return table;
}

float fade(float t) { return t * t * (3.0F - 2.0F * t); }

float corner(int x, int y, std::uint32_t seed, int period) {
  if (period > 0) {
    x = ((x % period) + period) % period;
    y = ((y % period) + period) % period;
  }
  return 2.0F * uniform(hash(seed, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y))) -
         1.0F;
}

float lerp(float a, float b, float t) { return a + (b - a) * t; }

}  // namespace

float gaussian(std::uint32_t h) {
  static const auto table = normalQuantiles();
  return table[h >> (32 - kTableBits)];
}

float latticeNoise(float x, float y, std::uint32_t seed, int period) {
  const float fx = std::floor(x), fy = std::floor(y);
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  const float tx = fade(x - fx), ty = fade(y - fy);
  return lerp(lerp(corner(ix, iy, seed, period), corner(ix + 1, iy, seed, period), tx),
              lerp(corner(ix, iy + 1, seed, period), corner(ix + 1, iy + 1, seed, period), tx), ty);
}

float latticeNoise(const Eigen::Vector3f& p, std::uint32_t seed) {
  const float fz = std::floor(p.z());
  const auto layer = static_cast<std::uint32_t>(static_cast<int>(fz));
  return lerp(latticeNoise(p.x(), p.y(), hash(seed, layer)),
              latticeNoise(p.x(), p.y(), hash(seed, layer + 1U)), fade(p.z() - fz));
}

float fractalNoise(float x, float y, std::uint32_t seed, int octaves, int period) {
  float sum = 0.0F, height = 0.5F;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += height * latticeNoise(x, y, seed + static_cast<std::uint32_t>(octave), period);
    x *= 2.0F;
    y *= 2.0F;
    period *= 2;
    height *= 0.5F;
  }
  return sum;
}

}  // namespace pf::simulator
