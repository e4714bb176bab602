// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>

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
  bool forced = false;  ///< it passes only because too many before it were dropped: it is blurred
                        ///< and should be located, not fused
};

/// Decides which frames are too blurred, from their sharpness and the recent past. Not thread safe.
class BlurGate {
 public:
  explicit BlurGate(const BlurConfig& config);

  /// Call once for each frame, in order.
  BlurScore judge(const Sharpness& sharpness);
  void reset();

  /// From the next frame on; what is known of the recent frames stays.
  void set(const BlurConfig& config) { config_ = config; }

 private:
  double threshold() const;

  BlurConfig config_;
  std::deque<double> recent_;  // fine detail of the last frames, dropped ones too
  int drops_in_a_row_ = 0;
};

}  // namespace pf
