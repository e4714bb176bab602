// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "posefusion/calibration/color_estimate.hpp"
#include "posefusion/core/stopwatch.hpp"
#include "posefusion/core/trajectory.hpp"
#include "posefusion/evaluation/map_check.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "posefusion/run/people_picture.hpp"
#include "posefusion/run/run_statistics.hpp"

namespace pf {

/// Accuracy of a run against the truth.
struct RunErrors {
  ErrorStatistics ate_m;
  ErrorStatistics held_m;  ///< heldError(): all frames, those without a pose with the last one
  std::size_t wrong = 0;   ///< wrongPoses()
  RelativeError per_second;
  std::size_t false_count = 0;  ///< of placeErrors()
};

/// Errors of the poses as reported at the time: what a robot acted on.
struct LiveErrors {
  ErrorStatistics ate_m;
  std::size_t wrong = 0;
  std::size_t false_count = 0;
};

/// Collects what a run gives, and writes it into a folder.
class RunReport {
 public:
  explicit RunReport(const Config& config) : config_(config) {}

  /// Each frame, in order. The clock of the run starts with the object and stops with the last
  /// frame.
  void add(const ProcessedFrame& frame);

  void addLeftOut(const std::string& outcome) { statistics_.addLeftOut(outcome); }

  void setTruth(const Trajectory& truth) { truth_ = truth; }

  /// Times (ms) of the loop closer's work beside the chain.
  void setVerification(const std::vector<double>& times_ms) {
    for (const double ms : times_ms) statistics_.addTime("loop_verification", ms);
  }

  /// How colour lay over depth, if that was looked at.
  void setColor(const std::optional<ColorEstimate>& estimate) { color_ = estimate; }

  /// Reported as `depth_median_difference_m`.
  void setDepthCheck(const DepthCheck& check) { depth_difference_m_ = check.medianM(); }

  /// The corrected trajectory, and what was done to loops, once all frames were added.
  void setBackEnd(const BackEnd& back_end, const LoopCounts& loops);

  /// In place of setBackEnd(), where the chain ran in another process.
  void setCorrected(const Trajectory& trajectory);

  const RunStatistics& statistics() const { return statistics_; }
  /// The frames that have a pose of their own, as they were reported at the time; as corrected by
  /// loops after setBackEnd().
  const Trajectory& trajectory() const { return trajectory_; }
  double framesPerSecond() const;
  /// Nothing without truth, or when fewer than three poses have a true one.
  std::optional<RunErrors> errors() const;
  /// Nothing without truth, before setBackEnd(), or for fewer than three poses with a true one.
  std::optional<LiveErrors> liveErrors() const;

  /// trajectory.txt (TUM format, camera poses of the frames that have one, corrected by loops) and
  /// trajectory_live.txt (as reported at the time), in the frame that `T_world_map` leads to.
  /// Throws InputError naming the file.
  void writeTrajectories(const std::string& folder,
                         const Eigen::Isometry3d& T_world_map = bodyFromOptical()) const;

  /// summary.json; `surfels`: savedSurfels() of the map. Throws InputError naming the file.
  void writeSummary(const std::string& folder, std::size_t surfels) const;

  /// map.png and people.png. `map` lies in the frame of the trajectory. Throws InputError naming
  /// the file.
  void writePictures(const std::string& folder, const SurfelMap& map) const;

  /// A few lines for people.
  std::string table() const;

 private:
  std::string summary(std::size_t surfels) const;
  std::string errorLines() const;

  Config config_;
  RunStatistics statistics_;
  std::vector<std::int64_t> frames_ns_;  // of all frames that could be read
  Trajectory trajectory_;
  Trajectory live_;  ///< as reported at the time
  Trajectory truth_;
  LoopCounts loops_;
  BackEnd::Counts corrections_;
  bool ran_elsewhere_ = false;  ///< loops and memory are not known
  PeopleStrip strip_;
  PinholeCamera camera_;
  std::optional<double> depth_difference_m_;
  std::optional<ColorEstimate> color_;
  Stopwatch watch_;
  double seconds_ = 0;
};

}  // namespace pf
