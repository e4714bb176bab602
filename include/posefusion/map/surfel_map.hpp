// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "posefusion/map/config.hpp"

namespace pf {

/// Surfels as structure of arrays, in the map frame, in the order in which they were made. One disc
/// each: position (m), unit normal, mean colour (0..255), radius (m).
struct SurfelArrays {
  std::vector<float> x, y, z;
  std::vector<float> nx, ny, nz;
  std::vector<float> r, g, b;
  std::vector<float> radius;
  std::vector<float> weight;                ///< of the running means; a measurement at 1 m counts 1
  std::vector<float> confidence;            ///< frames that supported it
  std::vector<std::int32_t> created, seen;  ///< frame numbers: made, last supported
  std::vector<std::int32_t> violations;     ///< frames that saw through it, less those that did not

  std::size_t size() const { return x.size(); }
  /// Calls visit(array) for each array above.
  template <typename Visit>
  void forEachArray(const Visit& visit) {
    for (auto* v : {&x, &y, &z, &nx, &ny, &nz, &r, &g, &b, &radius, &weight, &confidence}) {
      visit(*v);
    }
    for (auto* v : {&created, &seen, &violations}) visit(*v);
  }
  static constexpr std::size_t bytesPerSurfel() { return 12 * sizeof(float) + 3 * sizeof(int32_t); }
};

/// The surfels and the frame clock. Has one owner (the mapper); changed by fuse() alone.
class SurfelMap {
 public:
  explicit SurfelMap(const MapConfig& config) : config_(config) {}

  const MapConfig& config() const { return config_; }
  const SurfelArrays& surfels() const { return surfels_; }
  SurfelArrays& surfels() { return surfels_; }

  /// Number of the last fused frame, from 0; -1 while the map is empty.
  int frame() const { return frame_; }
  void advance() { ++frame_; }

  bool isActive(std::size_t i) const {
    return frame_ - surfels_.seen[i] <= config_.active_window_frames;
  }
  bool isStable(std::size_t i) const {
    return surfels_.confidence[i] >= static_cast<float>(config_.stable_confidence);
  }
  std::size_t capacity() const;
  std::size_t stableCount() const;

  /// Surfels that the memory limit kept out since the last clear().
  std::size_t refused() const { return refused_; }
  void countRefused(std::size_t n) { refused_ += n; }

  void clear();

 private:
  MapConfig config_;
  SurfelArrays surfels_;
  int frame_ = -1;
  std::size_t refused_ = 0;
};

}  // namespace pf
