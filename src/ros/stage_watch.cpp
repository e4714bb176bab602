// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/stage_watch.hpp"

#include <algorithm>
#include <vector>

#include "posefusion_ros/bags/messages.hpp"
#include "posefusion_ros/bags/stage_messages.hpp"

namespace posefusion_ros {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using std::chrono::duration;

constexpr double kSilent_s = 5.0;
constexpr double kManyGivenUp = 0.1;
constexpr std::size_t kLatencies = 300;  // ten seconds of frames

bool isHarmless(std::uint8_t outcome) {
  return outcome == TrackingStatusMsg::BLURRED || outcome == TrackingStatusMsg::FORCED ||
         outcome == TrackingStatusMsg::PAUSED;
}

}  // namespace

void StageWatch::passed(Time now, double latency_s) {
  const std::lock_guard<std::mutex> lock(mutex_);
  heard_ = now;
  ++passed_;
  ++new_passed_;
  latencies_s_.push_back(latency_s);
  if (latencies_s_.size() > kLatencies) latencies_s_.pop_front();
}

void StageWatch::givenUp(Time now, std::uint8_t outcome) {
  const std::lock_guard<std::mutex> lock(mutex_);
  heard_ = now;
  ++given_up_[outcomeName(outcome)];
  if (!isHarmless(outcome)) ++new_given_up_;
}

void StageWatch::tellClock(const std::string& defect) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (clock_ != defect) latencies_s_.clear();
  clock_ = defect;
}

void StageWatch::set(const std::string& key, const std::string& value) {
  const std::lock_guard<std::mutex> lock(mutex_);
  values_[key] = value;
}

void StageWatch::tell(int level, const std::string& text) {
  const std::lock_guard<std::mutex> lock(mutex_);
  level_ = level;
  told_ = text;
}

void StageWatch::allowSilence() {
  const std::lock_guard<std::mutex> lock(mutex_);
  may_be_silent_ = true;
}

void StageWatch::judge(Time now, diagnostic_updater::DiagnosticStatusWrapper& out) const {
  out.summary(DiagnosticStatus::OK, "frames pass");
  if (level_ != DiagnosticStatus::OK) out.mergeSummary(level_, told_);
  if (!clock_.empty()) out.mergeSummary(DiagnosticStatus::WARN, clock_);
  const double silent_s = duration<double>(now - heard_).count();
  if (silent_s >= kSilent_s && !may_be_silent_)
    out.mergeSummaryf(DiagnosticStatus::WARN, "no frame for %.0f s", silent_s);
  const std::size_t came = new_passed_ + new_given_up_;
  if (static_cast<double>(new_given_up_) > kManyGivenUp * static_cast<double>(came)) {
    out.mergeSummaryf(DiagnosticStatus::WARN, "%zu of %zu frames given up", new_given_up_, came);
  }
}

void StageWatch::addLatency(diagnostic_updater::DiagnosticStatusWrapper& out) const {
  const char *const median = "after the stamp, median (ms)", *const late =
                                                                 "after the stamp, 99 % (ms)";
  if (!clock_.empty()) {
    out.add(median, "unknown");
    out.add(late, "unknown");
    return;
  }
  if (latencies_s_.empty()) return;
  std::vector<double> sorted(latencies_s_.begin(), latencies_s_.end());
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](double part) {
    return 1e3 * sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
  };
  out.addf(median, "%.1f", at(0.5));
  out.addf(late, "%.1f", at(0.99));
}

void StageWatch::report(Time now, diagnostic_updater::DiagnosticStatusWrapper& out) {
  const std::lock_guard<std::mutex> lock(mutex_);
  judge(now, out);
  const double seconds = duration<double>(now - reported_).count();
  if (seconds > 0) out.addf("rate (Hz)", "%.1f", static_cast<double>(new_passed_) / seconds);
  out.add("frames", passed_);
  addLatency(out);
  for (const auto& [reason, count] : given_up_) out.add("given up: " + reason, count);
  for (const auto& [key, value] : values_) out.add(key, value);
  reported_ = now;
  new_passed_ = new_given_up_ = 0;
}

}  // namespace posefusion_ros
