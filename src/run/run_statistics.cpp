// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/run/run_statistics.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>

namespace pf {
namespace {

constexpr std::int64_t kMinute_ns = 60'000'000'000;

StageTime summarise(std::vector<double> times) {
  if (times.empty()) return {};
  std::sort(times.begin(), times.end());
  const auto at = [&](std::size_t thousandths) { return times[times.size() * thousandths / 1000]; };
  return {at(500), at(950), at(990), at(999), times.back()};
}

double shareOf(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

}  // namespace

double FrameCounts::poseShare() const { return shareOf(posed, read); }
double FrameCounts::sharpPoseShare() const { return shareOf(posed, read - blurred); }

void RunStatistics::add(const ProcessedFrame& frame) {
  ++frames_.read;
  ++frames_.by_state[std::string(name(frame.status.state))];
  ++frames_.by_outcome[std::string(name(frame.status.outcome))];
  if (frame.status.located) ++frames_.posed;
  switch (frame.status.outcome) {
    case FrameOutcome::bad_input:
      ++frames_.bad;
      return;
    case FrameOutcome::blurred:
      ++frames_.blurred;
      addTime("gate", frame.seen.gate_ms);
      return;
    case FrameOutcome::forced:
      ++(frame.status.located ? frames_.tracked : frames_.lost);
      break;
    case FrameOutcome::fused:
    case FrameOutcome::located:
      ++frames_.tracked;
      break;
    default:
      ++frames_.lost;
  }
  addMask(frame);
  addTimes(frame);
}

void RunStatistics::addLeftOut(const std::string& outcome) {
  ++frames_.read;
  ++frames_.left_out;
  ++frames_.by_outcome[outcome];
}

void RunStatistics::addMask(const ProcessedFrame& frame) {
  ++masks_.frames;
  const cv::Mat& mask = frame.segmentation.mask;
  const int pixels = mask.empty() ? 0 : cv::countNonZero(mask);
  if (pixels == 0) return;
  ++masks_.with_mask;
  const double part = static_cast<double>(pixels) / static_cast<double>(mask.total());
  masks_.over_1_percent += part > 0.01;
  mask_part_sum_ += part;
}

void RunStatistics::addTimes(const ProcessedFrame& frame) {
  addTime("gate", frame.seen.gate_ms);
  if (frame.seen.people.detected) addTime("pose", frame.seen.pose_ms);
  addTime("flow", frame.seen.flow_ms);
  addTime("segmentation", frame.segmentation_ms);
  addTime("tracking", frame.status.tracking_ms);
  addTime("fusion", frame.status.fusion_ms);
  addTime("tracking_and_fusion", frame.status.tracking_ms + frame.status.fusion_ms);
  addTime("loop_closing", frame.loop_ms);
  addTime("loop_waiting", frame.loop_wait_ms);
  if (!first_stamp_ns_) first_stamp_ns_ = frame.status.stamp_ns;
  const double whole = frame.seen.gate_ms + frame.seen.pose_ms + frame.seen.flow_ms +
                       frame.segmentation_ms + frame.status.tracking_ms + frame.status.fusion_ms +
                       (std::isnan(frame.loop_ms) ? 0.0 : frame.loop_ms);
  if (!std::isnan(whole)) {
    minutes_ms_[(frame.status.stamp_ns - *first_stamp_ns_) / kMinute_ns].push_back(whole);
  }
}

void RunStatistics::addTime(const char* stage, double ms) {
  if (!std::isnan(ms)) times_ms_[stage].push_back(ms);
}

MaskCounts RunStatistics::masks() const {
  MaskCounts masks = masks_;
  if (masks.frames > 0) masks.mean_part = mask_part_sum_ / static_cast<double>(masks.frames);
  return masks;
}

std::map<std::string, StageTime> RunStatistics::stages() const {
  std::map<std::string, StageTime> stages;
  for (const auto& [name, times] : times_ms_) stages[name] = summarise(times);
  return stages;
}

std::vector<StageTime> RunStatistics::minutes() const {
  std::vector<StageTime> found;
  for (const auto& [minute, times] : minutes_ms_) {
    found.resize(static_cast<std::size_t>(std::max<std::int64_t>(0, minute)) + 1);
    found.back() = summarise(times);
  }
  return found;
}

double peakMemoryMb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;  // Linux counts kilobytes
}

}  // namespace pf
