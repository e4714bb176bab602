// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "posefusion/core/map_pose.hpp"

namespace pf {

/// Surfels as structure of arrays, in the map frame. One disc each: position (m), unit normal, mean
/// colour (0..255), radius (m).
struct SurfelArrays {
  std::vector<float> x, y, z;
  std::vector<float> nx, ny, nz;
  std::vector<float> r, g, b;
  std::vector<float> radius;
  std::vector<float> weight;                ///< of the running means; a measurement at 1 m counts 1
  std::vector<float> odds;                  ///< that it stands still (nats), see static_odds
  std::vector<std::int32_t> created, seen;  ///< frame numbers: made, last supported

  std::size_t size() const { return x.size(); }

  /// Calls visit(array) for each array above.
  template <typename Visit>
  void forEachArray(const Visit& visit) {
    for (const auto member : kFloats) visit(this->*member);
    for (const auto member : kIntegers) visit(this->*member);
  }

  /// Calls visit(array, array of `other`) for each array above.
  template <typename Visit>
  void forEachArray(const SurfelArrays& other, const Visit& visit) {
    for (const auto member : kFloats) visit(this->*member, other.*member);
    for (const auto member : kIntegers) visit(this->*member, other.*member);
  }

  void resize(std::size_t count) {
    forEachArray([&](auto& array) { array.resize(count); });
  }

  /// Adds `from`'s surfels named by indices[0 .. count).
  void append(const SurfelArrays& from, const std::uint32_t* indices, std::size_t count) {
    forEachArray(from, [&](auto& array, const auto& other) {
      for (std::size_t i = 0; i < count; ++i) array.push_back(other[indices[i]]);
    });
  }

  /// Adds all of another's surfels.
  void append(const SurfelArrays& from) {
    forEachArray(from, [](auto& array, const auto& other) {
      array.insert(array.end(), other.begin(), other.end());
    });
  }

  static constexpr std::size_t bytesPerSurfel() { return 12 * sizeof(float) + 2 * sizeof(int32_t); }

 private:
  using Floats = std::vector<float> SurfelArrays::*;
  using Integers = std::vector<std::int32_t> SurfelArrays::*;
  static constexpr Floats kFloats[] = {
      &SurfelArrays::x,  &SurfelArrays::y,      &SurfelArrays::z,      &SurfelArrays::nx,
      &SurfelArrays::ny, &SurfelArrays::nz,     &SurfelArrays::r,      &SurfelArrays::g,
      &SurfelArrays::b,  &SurfelArrays::radius, &SurfelArrays::weight, &SurfelArrays::odds};
  static constexpr Integers kIntegers[] = {&SurfelArrays::created, &SurfelArrays::seen};
};

/// Surfels of one fragment of the map.
struct FragmentSurfels {
  int fragment = kFirstFragment;
  SurfelArrays surfels;
};

inline std::size_t surfelsIn(const std::vector<FragmentSurfels>& parts) {
  std::size_t count = 0;
  for (const FragmentSurfels& part : parts) count += part.surfels.size();
  return count;
}

}  // namespace pf
