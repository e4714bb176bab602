// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

namespace pf::simulator {

/// Random numbers are hashes of what they are for (seed, frame, pixel, purpose), never a running
/// state: the same for any number of threads and any order of work.
inline std::uint32_t mix(std::uint64_t x) {
  // The finaliser of SplitMix64 (Steele, Lea, Flood 2014).
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return static_cast<std::uint32_t>((x ^ (x >> 31)) >> 16);
}

inline std::uint32_t hash(std::uint32_t a, std::uint32_t b) {
  return mix((static_cast<std::uint64_t>(a) << 32) | b);
}
inline std::uint32_t hash(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return hash(hash(a, b), c);
}
inline std::uint32_t hash(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  return hash(hash(hash(a, b), c), d);
}

/// Uniform in [0, 1).
inline float uniform(std::uint32_t h) { return static_cast<float>(h >> 8) * 0x1p-24F; }

/// Uniform in [low, high).
inline double between(std::uint32_t h, double low, double high) {
  return low + (high - low) * static_cast<double>(uniform(h));
}

/// Standard normal, from a table of 4096 equally likely values: cheap enough for every pixel.
float gaussian(std::uint32_t h);

/// Numbers one after another for building things (rooms, clothes): a counter that is hashed.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : seed_(seed) {}
  std::uint32_t next() { return hash(seed_, counter_++); }
  double between(double low, double high) { return simulator::between(next(), low, high); }
  bool chance(double probability) { return uniform(next()) < probability; }
  int below(int count) { return static_cast<int>(next() % static_cast<std::uint32_t>(count)); }

 private:
  std::uint32_t seed_;
  std::uint32_t counter_ = 0;
};

inline float random(Dice& dice, double low, double high) {
  return static_cast<float>(dice.between(low, high));
}

/// Smooth noise in [-1, 1] on the integer lattice, period `period` cells in each axis (0: none).
float latticeNoise(float x, float y, std::uint32_t seed, int period = 0);
float latticeNoise(const Eigen::Vector3f& p, std::uint32_t seed);

/// Sum of `octaves` of lattice noise, each of half the size and half the height: a 1/f spectrum as
/// natural surfaces have it. Periodic with `period` cells of the first octave.
float fractalNoise(float x, float y, std::uint32_t seed, int octaves, int period = 0);

}  // namespace pf::simulator
