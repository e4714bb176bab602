// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/status.hpp"

namespace pf {

std::string_view name(TrackingState state) {
  switch (state) {
    case TrackingState::initializing:
      return "initializing";
    case TrackingState::tracking:
      return "tracking";
    case TrackingState::doubtful:
      return "doubtful";
    case TrackingState::lost:
      return "lost";
  }
  return "unknown";
}

std::string_view name(FrameOutcome outcome) {
  switch (outcome) {
    case FrameOutcome::fused:
      return "fused";
    case FrameOutcome::bad_input:
      return "bad_input";
    case FrameOutcome::blurred:
      return "blurred";
    case FrameOutcome::no_depth:
      return "no_depth";
    case FrameOutcome::not_converged:
      return "not_converged";
    case FrameOutcome::few_inliers:
      return "few_inliers";
    case FrameOutcome::degenerate:
      return "degenerate";
    case FrameOutcome::jumped:
      return "jumped";
    case FrameOutcome::disagrees:
      return "disagrees";
    case FrameOutcome::seen_through:
      return "seen_through";
    case FrameOutcome::unproven:
      return "unproven";
    case FrameOutcome::forced:
      return "forced";
    case FrameOutcome::located:
      return "located";
  }
  return "unknown";
}

std::string reasonOf(const FrameStatus& status) {
  if (isGood(status.outcome)) return {};
  return std::string(name(status.outcome)) + (status.detail.empty() ? "" : ": " + status.detail);
}

}  // namespace pf
