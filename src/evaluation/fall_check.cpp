// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/fall_check.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

constexpr double kWrong_m = 0.10, kWrong_rad = 5.0 * M_PI / 180.0;

}  // namespace

void FallFrame::setError(const Eigen::Isometry3d& T_true_pose) {
  error_m = T_true_pose.translation().norm();
  error_rad = angleOf(T_true_pose);
}

bool FallFrame::isWrong() const { return error_m > kWrong_m || error_rad > kWrong_rad; }

std::optional<double> FallReturn::seconds() const {
  if (!was_lost) return 0.0;
  if (!seen_ns || !found_ns) return std::nullopt;
  return 1e-9 * static_cast<double>(std::max<std::int64_t>(0, *found_ns - *seen_ns));
}

FallReturn checkReturn(const std::vector<FallFrame>& frames, std::int64_t up_ns) {
  FallReturn fall;
  const auto loss =
      std::find_if(frames.begin(), frames.end(), [](const auto& f) { return f.lost; });
  fall.was_lost = loss != frames.end();
  bool is_after = !fall.was_lost;
  for (const FallFrame& frame : frames) {
    if (frame.has_pose) {
      fall.wrong += frame.isWrong() ? 1 : 0;
      fall.worst_from_truth_m = std::max(fall.worst_from_truth_m, frame.from_truth_m);
    }
    is_after = is_after || frame.lost;
    if (!is_after) continue;
    if (!fall.seen_ns && !frame.blurred && frame.overlap >= kCoveredOverlap) {
      fall.seen_ns = frame.stamp_ns;
    }
    if (!fall.found_ns && frame.tracking) fall.found_ns = frame.stamp_ns;
    if (frame.overlap < kKnownOverlap) continue;
    for (auto* known : {&fall.since_loss, &fall.once_up}) {
      if (known == &fall.once_up && frame.stamp_ns < up_ns) continue;
      ++known->frames;
      known->posed += frame.has_pose ? 1 : 0;
    }
  }
  return fall;
}

}  // namespace pf
