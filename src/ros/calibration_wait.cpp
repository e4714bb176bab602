// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/calibration_wait.hpp"

#include "posefusion/core/error.hpp"

namespace posefusion_ros {
namespace {

// The field of hundreds of keyframes takes seconds; callers of services do not wait for ever.
constexpr std::chrono::seconds kLongest{20};
// As long as /diagnostics and the log bear it that nothing comes.
constexpr std::chrono::seconds kNoFrame{5};

}  // namespace

std::string CalibrationWait::look(const CalibrationProgress& progress, Clock::time_point now) {
  if (progress.frames != newest_.frames) frame_came_ = now;
  newest_ = progress;
  if (progress.version != asked_.version) return progress.said;
  if (!progress.said.empty()) throw pf::InputError(progress.said);
  if (progress.unanswered != asked_.unanswered) {
    throw pf::InputError(
        "the loop closer has left a question without an answer: expected a nodelet "
        "posefusion/loop_closer that works");
  }
  if (now - frame_came_ > kNoFrame) {
    throw pf::InputError("no frame has come for " + std::to_string(kNoFrame.count()) +
                         " s, and the loop closer is asked between two frames");
  }
  if (now - begun_ > kLongest) {
    throw pf::InputError("the loop closer has not answered within " +
                         std::to_string(kLongest.count()) + " s: the log shows what it learns");
  }
  return {};
}

}  // namespace posefusion_ros
