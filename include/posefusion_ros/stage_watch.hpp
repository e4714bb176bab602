// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <string>

namespace posefusion_ros {

/// What /diagnostics reports of one nodelet of the chain: how fast frames pass, how late they are,
/// how many are given up and why, and values of its own. Thread safe.
class StageWatch {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit StageWatch(Time now) : reported_(now), heard_(now) {}

  /// A frame is done, so long after its stamp.
  void passed(Time now, double latency_s);

  /// A frame is given up; `outcome` is one of TrackingStatusMsg.
  void givenUp(Time now, std::uint8_t outcome);

  /// Why stamps and ROS time are of different clocks, reported as WARN; empty: they are of one. How
  /// late frames pass is not known then.
  void tellClock(const std::string& defect);

  /// A value of the nodelet's own, shown until it is set anew.
  void set(const std::string& key, const std::string& value);

  /// How the nodelet is, besides its frames: a level of DiagnosticStatus, and why where it is not
  /// OK. Holds until the next call.
  void tell(int level, const std::string& text);

  /// From now on it is no warning that nothing comes.
  void allowSilence();

  /// Level, message and values; rates and shares are those since the last report. WARN where no
  /// frame came for 5 s, and where more than a tenth was given up for another reason than blur
  /// and pauses.
  void report(Time now, diagnostic_updater::DiagnosticStatusWrapper& out);

 private:
  void judge(Time now, diagnostic_updater::DiagnosticStatusWrapper& out) const;
  void addLatency(diagnostic_updater::DiagnosticStatusWrapper& out) const;

  std::mutex mutex_;
  Time reported_;                                // the last report
  Time heard_;                                   // the last frame, passed or not
  std::size_t passed_ = 0;                       // since the beginning
  std::size_t new_passed_ = 0;                   // since the last report
  std::size_t new_given_up_ = 0;                 // of them, those worth a warning
  std::map<std::string, std::size_t> given_up_;  // since the beginning, by outcome
  std::deque<double> latencies_s_;               // of the last frames
  std::map<std::string, std::string> values_;
  std::string clock_;  // its defect
  int level_ = 0;
  std::string told_;
  bool may_be_silent_ = false;
};

}  // namespace posefusion_ros
