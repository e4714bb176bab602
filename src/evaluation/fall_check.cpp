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

std::optional<double> Loss::seconds() const {
  if (!seen_ns || !found_ns) return std::nullopt;
  return 1e-9 * static_cast<double>(std::max<std::int64_t>(0, *found_ns - *seen_ns));
}

std::optional<double> FallReturn::seconds() const {
  return was_lost ? slowest.seconds() : std::optional<double>(0.0);
}

namespace {

/// Whether one way back says more against a tracker than another: never found though the map was in
/// view, then the longer time; a loss in which the map was never in view says nothing.
bool isSlower(const Loss& a, const Loss& b) {
  const auto rank = [](const Loss& loss) { return !loss.seen_ns ? 0 : loss.found_ns ? 1 : 2; };
  if (rank(a) != rank(b)) return rank(a) > rank(b);
  return rank(a) == 1 && *a.seconds() > *b.seconds();
}

/// The losses one after the other; where there is none, the whole recording as if it began with
/// one.
std::vector<Loss> lossesIn(const std::vector<FallFrame>& frames, bool was_lost) {
  std::vector<Loss> losses;
  if (!was_lost) losses.emplace_back();
  bool is_lost = false;
  for (const FallFrame& frame : frames) {
    if (frame.lost && !is_lost) losses.emplace_back();
    is_lost = frame.lost || (is_lost && !frame.tracking);
    if (losses.empty()) continue;
    Loss& loss = losses.back();
    const bool covered = !frame.blurred && frame.overlap >= kCoveredOverlap;
    if (!loss.seen_ns && covered) loss.seen_ns = frame.stamp_ns;
    if (!loss.found_ns && frame.tracking) loss.found_ns = frame.stamp_ns;
  }
  return losses;
}

}  // namespace

FallReturn checkReturn(const std::vector<FallFrame>& frames, std::int64_t up_ns) {
  FallReturn fall;
  fall.was_lost = std::any_of(frames.begin(), frames.end(), [](const auto& f) { return f.lost; });
  const std::vector<Loss> losses = lossesIn(frames, fall.was_lost);
  fall.slowest = *std::max_element(losses.begin(), losses.end(),
                                   [](const Loss& a, const Loss& b) { return isSlower(b, a); });
  bool is_after = !fall.was_lost;
  for (const FallFrame& frame : frames) {
    if (frame.has_pose) {
      fall.wrong += frame.isWrong() ? 1 : 0;
      fall.worst_from_truth_m = std::max(fall.worst_from_truth_m, frame.from_truth_m);
    }
    is_after = is_after || frame.lost;
    if (!is_after || frame.overlap < kKnownOverlap) continue;
    for (auto* known : {&fall.since_loss, &fall.once_up}) {
      if (known == &fall.once_up && frame.stamp_ns < up_ns) continue;
      ++known->frames;
      known->posed += frame.has_pose ? 1 : 0;
    }
  }
  return fall;
}

}  // namespace pf
