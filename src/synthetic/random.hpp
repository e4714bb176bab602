// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace pf::synthetic {

/// Random bits that are a function of their index alone (the finaliser of SplitMix64), so that
/// pixels can be made in any order.
inline std::uint64_t randomBits(std::uint64_t index) {
  std::uint64_t x = index + 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Uniform in [0, 1) from ten bits, starting at bit `shift`.
inline float uniform(std::uint64_t bits, int shift) {
  return static_cast<float>((bits >> shift) & 1023U) / 1024.0F;
}

/// About normal, variance 1, from thirty bits: the sum of three uniform values.
inline float normal(std::uint64_t bits, int shift) {
  const float sum = uniform(bits, shift) + uniform(bits, shift + 10) + uniform(bits, shift + 20);
  return (sum - 1.5F) * 2.0F;
}

}  // namespace pf::synthetic
