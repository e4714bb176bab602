// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string>

#include "posefusion_ros/mapping_session.hpp"

namespace posefusion_ros {

/// Waits, look by look, for what becomes of MappingSession::askForCalibration().
class CalibrationWait {
 public:
  using Clock = std::chrono::steady_clock;

  /// How often to look.
  static constexpr std::chrono::milliseconds kPeriod{50};

  CalibrationWait() = default;
  /// `asked`: just after it was asked for.
  explicit CalibrationWait(CalibrationProgress asked, Clock::time_point now = Clock::now())
      : asked_(std::move(asked)), newest_(asked_), begun_(now), frame_came_(now) {}

  /// What was learned, as a sentence; empty while that is not known yet. Throws InputError with the
  /// reason where nothing was learned, or there is no answer.
  std::string look(const CalibrationProgress& progress, Clock::time_point now = Clock::now());

 private:
  CalibrationProgress asked_, newest_;
  Clock::time_point begun_, frame_came_;
};

}  // namespace posefusion_ros
