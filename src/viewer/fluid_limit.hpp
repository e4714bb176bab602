// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace posefusion_ros {

/// How many discs can be drawn at eight frames a second or more, from how fast they were: fewer
/// where two looks in a row were too slow (software rendering), more again where there is room for
/// twice as many.
class FluidLimit {
 public:
  std::size_t discs() const { return discs_; }

  /// A frame with `shown` discs of `all` was drawn, so long after the one before. True: another
  /// number of discs is to be drawn from now on.
  bool drawn(float seconds, std::size_t shown, std::size_t all) {
    ++frames_;
    frames_s_ += seconds;
    if (frames_s_ < kLook_s) return false;
    const float rate = static_cast<float>(frames_) / frames_s_;
    frames_ = 0;
    frames_s_ = 0;
    slow_looks_ = rate < kFluid_hz ? slow_looks_ + 1 : 0;
    fast_looks_ = rate > kAmple_hz ? fast_looks_ + 1 : 0;
    if (slow_looks_ >= 2 && shown > kFewest) {
      const float part = std::clamp(kReserve * rate / kFluid_hz, kLeastPart, kReserve);
      return set(std::max(kFewest, static_cast<std::size_t>(part * static_cast<float>(shown))));
    }
    if (fast_looks_ >= 2 && shown < all) return set(2 * shown);
    return false;
  }

 private:
  static constexpr float kFluid_hz = 8, kAmple_hz = 20, kLook_s = 1.5F;
  static constexpr float kReserve = 0.8F, kLeastPart = 0.15F;
  static constexpr std::size_t kFewest = 30000;

  bool set(std::size_t discs) {
    slow_looks_ = fast_looks_ = 0;
    discs_ = discs;
    return true;
  }

  std::size_t discs_ = SIZE_MAX;
  int frames_ = 0;      // since the last look
  float frames_s_ = 0;  // that they took
  int slow_looks_ = 0, fast_looks_ = 0;
};

}  // namespace posefusion_ros
