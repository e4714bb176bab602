// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <future>
#include <optional>
#include <vector>

#include "posefusion/calibration/color_estimate.hpp"
#include "posefusion/calibration/color_registration.hpp"
#include "posefusion/calibration/config.hpp"

namespace pf {

/// Finds out in the first seconds whether colour lies over depth, and registers it where it does
/// not. The same frames give the same bytes: the estimate is worked out in a thread of its own, and
/// taken up at a frame that its time does not decide. Not thread safe.
class ColorLearner {
 public:
  explicit ColorLearner(const CalibrationConfig& config = {}) : config_(config) {}

  /// Before the first frame: the colour camera is known, and nothing is to be learned.
  void give(const ColorCamera& camera) { registration_.emplace(camera); }

  /// The frame with colour registered to depth, as far as it is known: the same pixels where
  /// nothing is known, or nothing is wrong. `frame`: sharp, without lens distortion.
  RgbdFrame registered(const RgbdFrame& frame);

  /// What was found, from the frame on that it is used at; its doubt says why it is not used.
  const std::optional<ColorEstimate>& estimate() const { return estimate_; }

 private:
  void learn(const RgbdFrame& frame);
  void takeUp(std::int64_t stamp_ns);

  CalibrationConfig config_;
  PinholeCamera camera_;
  std::vector<EdgeView> views_;
  std::int64_t last_ns_ = 0;
  std::future<ColorEstimate> working_;
  std::optional<ColorEstimate> estimate_;
  std::optional<ColorRegistration> registration_;
};

}  // namespace pf
