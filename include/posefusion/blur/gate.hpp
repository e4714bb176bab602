// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <limits>

#include "posefusion/blur/config.hpp"
#include "posefusion/blur/sharpness.hpp"

namespace pf {

/// What the gate says of one frame.
struct BlurScore {
  double score = 0.0;    ///< variance of the Laplacian, grey levels squared
  double measure = 0.0;  ///< what is compared with the threshold: the score where a fixed threshold
                         ///< is set, else Sharpness::fine_detail
  double threshold = 0.0;  ///< 0 while nothing is known yet
  bool sharp = true;       ///< the frame may pass
  bool forced = false;     ///< it passes only because none has for long: it is blurred and should
                           ///< be located, not fused
};

/// Decides which frames are too blurred, from their sharpness and the recent past. Not thread safe.
class BlurGate {
 public:
  explicit BlurGate(const BlurConfig& config);

  /// Call once for each frame, in order. Where stamps jump back the gap is counted anew.
  BlurScore judge(const Sharpness& sharpness, std::int64_t stamp_ns);
  void reset();

  /// From the next frame on; what is known of the recent frames stays.
  void set(const BlurConfig& config) { config_ = config; }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

  struct Past {
    std::int64_t stamp_ns;
    double fine_detail;
  };

  double threshold() const;
  bool isOld(const Past& past, std::int64_t stamp_ns) const;
  /// Whether no frame has passed for so long that this one has to.
  bool isDue(std::int64_t stamp_ns) const;

  BlurConfig config_;
  std::deque<Past> recent_;          // the last frames, dropped ones too
  std::int64_t passed_ns_ = kNever;  // stamp of the last frame that passed, or of the first one
};

}  // namespace pf
